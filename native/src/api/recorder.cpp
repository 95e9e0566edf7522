#include "api/recorder.h"

#include <fstream>
#include <iterator>

#include <nlohmann/json.hpp>

#include "api/archive.h"
#include "api/scene_file.h"
#include "film_io/file_writer.h"
#include "image/image_store.h"
#include "schema/options.h"

namespace gradus::api {
namespace {

// Returns the contents of a file, or nothing if it cannot be read. The record then holds the path, and a warning is
// given when the scene is loaded.
std::vector<char> read_bytes(const char* path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

void write_record(film_io::FileWriter* file, RecordKind kind, uint64_t key, const std::vector<char>& bytes) {
  const RecordHeader header{static_cast<uint32_t>(kind), 0, key, bytes.size(), checksum(bytes.data(), bytes.size())};
  static const char padding[kArchiveAlignment] = {};
  file->write(&header, sizeof(header));
  file->write(bytes.data(), bytes.size());
  file->write(padding, padded(bytes.size()) - bytes.size());
}

}  // namespace

template <class T>
void SceneRecorder::store(RecordKind kind, uint64_t key, T value) {
  ArchiveWriter writer;
  visit(writer, value);
  records_[{kind, key}] = writer.take();
}

void SceneRecorder::set_mesh(uint64_t key, const GradusMesh& mesh) { store(RecordKind::Mesh, key, mesh); }
void SceneRecorder::set_material(uint64_t key, const GradusMaterial& material) {
  store(RecordKind::Material, key, material);
}
void SceneRecorder::set_instances(const GradusInstances& instances) { store(RecordKind::Instances, 0, instances); }
void SceneRecorder::set_lights(const std::vector<GradusLight>& lights) {
  store(RecordKind::Lights, 0, LightList{lights.data(), lights.size()});
}
void SceneRecorder::set_camera(const GradusCamera& camera) { store(RecordKind::Camera, 0, camera); }
void SceneRecorder::set_dicing_camera(const GradusCamera& camera) { store(RecordKind::DicingCamera, 0, camera); }
void SceneRecorder::remove_dicing_camera() { records_.erase({RecordKind::DicingCamera, 0}); }
void SceneRecorder::set_world(const GradusWorld& world) { store(RecordKind::World, 0, world); }

void SceneRecorder::set_channels(const std::vector<GradusChannel>& channels) {
  store(RecordKind::Channels, 0, ChannelList{channels.data(), channels.size()});
}

void SceneRecorder::set_image(uint64_t key, const GradusImage& image, const image::ColorManager& color) {
  const image::ImageSource source = image::scene_linear_source(image::copy_image_source(image), color);
  std::vector<GradusImageTile> tiles(image.tiles, image.tiles + image.tile_count);
  std::vector<std::vector<char>> packed(tiles.size());
  for (size_t i = 0; i < tiles.size(); ++i) {
    const image::ImageSource::Tile& tile = source.tiles[i];
    tiles[i].source = tile.source;
    tiles[i].width = tile.width;
    tiles[i].height = tile.height;
    tiles[i].data = tile.data.data();
    tiles[i].data_size = tile.data.size();
    if (tile.source != GRADUS_IMAGE_FILE) continue;
    packed[i] = read_bytes(tiles[i].path);
    if (packed[i].empty()) continue;
    tiles[i].source = GRADUS_IMAGE_ENCODED;
    tiles[i].data = packed[i].data();
    tiles[i].data_size = packed[i].size();
  }
  GradusImage copy = image;
  copy.tiles = tiles.data();
  copy.color_space = source.color_space.c_str();
  copy.alpha_mode = source.alpha_mode;
  copy.is_float = source.is_float;
  store(RecordKind::Image, key, copy);
}

void SceneRecorder::remove(GradusObjectKind kind, uint64_t key) {
  const RecordKind record = kind == GRADUS_KIND_MESH    ? RecordKind::Mesh
                            : kind == GRADUS_KIND_IMAGE ? RecordKind::Image
                                                        : RecordKind::Material;
  records_.erase({record, key});
}

void SceneRecorder::save(const std::string& path, const GradusSettings& settings) const {
  film_io::FileWriter file(path);
  const FileHeader header;
  file.write(&header, sizeof(header));
  const std::string text = schema::settings_to_json(settings).dump();
  write_record(&file, RecordKind::Settings, 0, {text.begin(), text.end()});
  for (const auto& [name, bytes] : records_) write_record(&file, name.first, name.second, bytes);
  write_record(&file, RecordKind::End, 0, {});
  file.commit();
}

}  // namespace gradus::api
