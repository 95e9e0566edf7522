#include "api/scene_file.h"

#include <fstream>
#include <memory>
#include <new>

#include <nlohmann/json.hpp>

#include "api/recorder.h"
#include "api/scene_args.h"
#include "scene/scene.h"
#include "schema/options.h"

namespace gradus::api {
namespace {

// The contents of a file, aligned so that a reader can point to the arrays in it.
class FileBytes {
 public:
  explicit FileBytes(const std::string& path) {
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    const std::streamoff size = file ? std::streamoff(file.tellg()) : -1;
    if (size < 0) throw invalid_argument("it cannot be read");
    size_ = size_t(size);
    data_.reset(static_cast<char*>(::operator new (size_ + 1, std::align_val_t{kArchiveAlignment})));
    file.seekg(0);
    if (!file.read(data_.get(), std::streamsize(size_))) throw invalid_argument("it cannot be read");
  }
  const char* data() const { return data_.get(); }
  size_t size() const { return size_; }

 private:
  struct Free {
    void operator()(char* p) const { ::operator delete (p, std::align_val_t{kArchiveAlignment}); }
  };
  std::unique_ptr<char, Free> data_;
  size_t size_ = 0;
};

template <class T>
T read_record(ArchiveReader* reader) {
  T value{};
  visit(*reader, value);
  return value;
}

void set_record(RecordKind kind, uint64_t key, const char* data, size_t size, scene::Scene* scene) {
  ArchiveReader reader(data, size);
  switch (kind) {
    case RecordKind::Image: {
      const GradusImage image = read_record<GradusImage>(&reader);
      return scene->set_image(key, ImageArgs(&image).image);
    }
    case RecordKind::Material: {
      const GradusMaterial material = read_record<GradusMaterial>(&reader);
      return scene->set_material(key, read_material(&material));
    }
    case RecordKind::Mesh: {
      const GradusMesh mesh = read_record<GradusMesh>(&reader);
      return scene->set_mesh(key, MeshArgs(&mesh).mesh);
    }
    case RecordKind::Instances: {
      const GradusInstances instances = read_record<GradusInstances>(&reader);
      return scene->set_instances(read_instances(&instances));
    }
    case RecordKind::Lights: {
      const LightList list = read_record<LightList>(&reader);
      const std::vector<GradusLight> lights = read_lights(list.items, list.count);
      return scene->set_lights(lights.data(), lights.size());
    }
    case RecordKind::Camera: {
      const GradusCamera camera = read_record<GradusCamera>(&reader);
      return scene->set_camera(read_camera(&camera));
    }
    case RecordKind::DicingCamera: {
      const GradusCamera record = read_record<GradusCamera>(&reader);
      const GradusCamera camera = read_camera(&record);
      return scene->set_dicing_camera(&camera);
    }
    case RecordKind::World: {
      const GradusWorld world = read_record<GradusWorld>(&reader);
      return scene->set_world(read_world(&world));
    }
    case RecordKind::Channels: {
      const ChannelList list = read_record<ChannelList>(&reader);
      const std::vector<GradusChannel> channels = read_channels(list.items, list.count);
      return scene->set_channels(channels.data(), channels.size());
    }
    default:
      throw invalid_argument("it holds a record of an unknown kind");
  }
}

bool has_key(RecordKind kind) {
  return kind == RecordKind::Image || kind == RecordKind::Material || kind == RecordKind::Mesh;
}

// Calls record_function(kind, key, data, size) for all records except the settings, which are returned.
template <class Function>
GradusSettings read_records(const FileBytes& file, Function&& record_function) {
  FileHeader header;
  const FileHeader expected;
  if (file.size() < sizeof(header)) throw invalid_argument("it is not a Gradus scene");
  std::memcpy(&header, file.data(), sizeof(header));
  if (std::memcmp(header.magic, expected.magic, sizeof(header.magic)) != 0)
    throw invalid_argument("it is not a Gradus scene");
  if (header.format != kSceneFormat || header.byte_order != expected.byte_order) {
    throw invalid_argument("it has format " + std::to_string(header.format) + ", this library reads format " +
                           std::to_string(kSceneFormat));
  }
  GradusSettings settings = schema::default_settings();
  for (uint64_t position = sizeof(header);;) {
    RecordHeader record;
    if (file.size() - position < sizeof(record)) throw invalid_argument("it ends too early");
    std::memcpy(&record, file.data() + position, sizeof(record));
    position += sizeof(record);
    if (record.size > file.size() - position || padded(record.size) > file.size() - position)
      throw invalid_argument("it ends too early");
    const char* data = file.data() + position;
    if (checksum(data, record.size) != record.checksum) throw invalid_argument("it is damaged");
    const auto kind = static_cast<RecordKind>(record.kind);
    if (kind == RecordKind::End) return settings;
    if (kind == RecordKind::Settings) {
      settings = schema::settings_from_json(nlohmann::json::parse(data, data + record.size));
    } else {
      if (has_key(kind) && record.key == 0) throw invalid_argument("it holds an object without a key");
      record_function(kind, record.key, data, record.size);
    }
    position += padded(record.size);
  }
}

void summarize(RecordKind kind, const char* data, size_t size, SceneSummary* summary) {
  ArchiveReader reader(data, size);
  if (kind == RecordKind::Mesh) {
    const GradusMesh mesh = read_record<GradusMesh>(&reader);
    ++summary->meshes;
    summary->vertices += mesh.vertex_count;
    summary->triangles += mesh.triangle_count;
  } else if (kind == RecordKind::Image) {
    ++summary->images;
    summary->image_bytes += size;
  } else if (kind == RecordKind::Material) {
    ++summary->materials;
    summary->nodes += read_record<GradusMaterial>(&reader).node_count;
  } else if (kind == RecordKind::Instances) {
    summary->instances = read_record<GradusInstances>(&reader).count;
  } else if (kind == RecordKind::Lights) {
    summary->lights = read_record<LightList>(&reader).count;
  } else if (kind == RecordKind::Camera) {
    summary->has_camera = true;
  }
}

// Calls function(contents of the file). An exception becomes an Error whose message has the path.
template <class Function>
auto loading(const std::string& path, Function&& function) {
  try {
    return function(FileBytes(path));
  } catch (const Error& e) {
    throw Error(e.code(), "cannot load scene " + path + ": " + e.what());
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& e) {
    throw invalid_argument("cannot load scene " + path + ": " + e.what());
  }
}

}  // namespace

GradusSettings load_scene(const std::string& path, scene::Scene* scene) {
  return loading(path, [&](const FileBytes& file) {
    return read_records(file, [&](RecordKind kind, uint64_t key, const char* data, size_t size) {
      set_record(kind, key, data, size, scene);
    });
  });
}

SceneSummary summarize_scene(const std::string& path) {
  return loading(path, [](const FileBytes& file) {
    SceneSummary summary;
    summary.file_bytes = file.size();
    summary.settings = read_records(
        file, [&](RecordKind kind, uint64_t, const char* data, size_t size) { summarize(kind, data, size, &summary); });
    return summary;
  });
}

}  // namespace gradus::api
