#include "film_io/store.h"

#include <array>
#include <atomic>
#include <cstdio>

#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include "base/cancel_check.h"
#include "base/error.h"
#include "film_io/block_file.h"
#include "film_io/block_rows.h"
#include "film_io/exr_stream.h"
#include "film_io/store_header.h"
#include "film_io/store_planes.h"

namespace gradus::film_io {
namespace {

// The number of a part and the number of one of its blocks.
struct PlacedBlock {
  int part = 0, block = 0;
};

// The rows of all parts, in the order in which their blocks follow each other in the file.
class PartRows {
 public:
  PartRows(const std::vector<StoredPart>& parts, const film::Film& film) {
    for (const StoredPart& part : parts) rows_.emplace_back(part.planes, film.region.width(), film.region.height());
  }
  int blocks() const { return int(rows_.size()) * rows_.front().blocks(); }
  PlacedBlock at(int i) const { return {i / rows_.front().blocks(), i % rows_.front().blocks()}; }
  const BlockRows& of(int part) const { return rows_[size_t(part)]; }

 private:
  std::vector<BlockRows> rows_;
};

// Packs the blocks in parallel and writes them in order.
//
// The pipeline passes numbers of blocks. The packed bytes wait in slots of their own: oneTBB loses what its tokens own
// if an exception, such as that of a cancel, ends a pipeline. No two blocks in flight share a slot, because they leave
// in order.
void write_blocks(const PartRows& rows, const CancelCheck& cancel, BlockFile* file) {
  tbb::enumerable_thread_specific<BlockCodec> codecs;
  std::vector<Bytes> slots(2 * size_t(tbb::this_task_arena::max_concurrency()));
  int next = 0;
  const auto number = [&](tbb::flow_control& control) {
    if (next == rows.blocks()) control.stop();
    return next++;
  };
  const auto pack = [&](int i) {
    throw_if_cancelled(cancel);
    const PlacedBlock place = rows.at(i);
    Bytes bytes(rows.of(place.part).bytes(place.block));
    rows.of(place.part).gather(place.block, &bytes);
    slots[size_t(i) % slots.size()] = codecs.local().pack(bytes);
    return i;
  };
  const auto write = [&](int i) {
    const PlacedBlock place = rows.at(i);
    file->write(place.part, place.block, slots[size_t(i) % slots.size()]);
  };
  tbb::parallel_pipeline(slots.size(), tbb::make_filter<void, int>(tbb::filter_mode::serial_in_order, number) &
                                           tbb::make_filter<int, int>(tbb::filter_mode::parallel, pack) &
                                           tbb::make_filter<int, void>(tbb::filter_mode::serial_in_order, write));
}

// Reads all blocks of some parts. numbers: the positions of these parts in the file.
void read_blocks(Imf::MultiPartInputFile* file, const PartRows& rows, const std::vector<int>& numbers,
                 const CancelCheck& cancel) {
  struct Reader {
    BlockCodec codec;
    Bytes packed, bytes;
  };
  tbb::enumerable_thread_specific<Reader> readers;
  std::vector<Imf::InputPart> inputs;
  for (const int number : numbers) inputs.emplace_back(*file, number);
  const int top = file->header(0).dataWindow().min.y;
  tbb::parallel_for(0, rows.blocks(), [&](int i) {
    throw_if_cancelled(cancel);
    const auto [part, block] = rows.at(i);
    const BlockRows& own = rows.of(part);
    Reader& reader = readers.local();
    reader.bytes.resize(own.bytes(block));
    reader.packed.resize(own.max_bytes());  // A damaged file may make OpenEXR read that much.
    int size = int(reader.packed.size());
    inputs[size_t(part)].rawPixelDataToBuffer(top + kBlockRows * block, reinterpret_cast<char*>(reader.packed.data()),
                                              size);
    if (!reader.codec.unpack(reader.packed.data(), size_t(size), &reader.bytes))
      throw invalid_argument("a block of its rows is broken");
    own.scatter(reader.bytes, block);
  });
}

void check_correspondences(const film::Film& film) {
  const auto check = [&](const film::PixelCorrespondence& correspondence) {
    for (const int32_t pixel : correspondence.pixel) {
      if (pixel < film::kNoCorrespondence || pixel >= film.region.area())
        throw invalid_argument("it replays pixels that do not exist");
    }
    for (const Vec2& off : correspondence.off_centre) {
      if (!(std::abs(off.x) <= 0.5f && std::abs(off.y) <= 0.5f))
        throw invalid_argument("it replays correspondences that end outside of their pixels");
    }
  };
  check(film.replayed.correspondence);
  for (const film::PixelCorrespondence& own : film.replayed.of_component) check(own);
}

// Maximum object number, up to which float represents every integer (film::ShownPoint).
constexpr float kObjects = 16777216.0f;

// Return whether a film can have this value.
bool is_sound(float value) { return is_finite(value); }
bool is_sound(const Vec4& value) { return is_finite(Vec3(value)) && is_finite(value.w); }
bool is_sound(const film::ShownPoint& shown) {
  return shown.object >= 0.0f && shown.object <= kObjects && is_finite(shown.depth);
}
bool is_sound(const film::NonSpecularVertices& non_specular) {
  return is_finite(non_specular.reflectance) && is_finite(non_specular.normal) &&
         is_finite(non_specular.inverse_depth) && is_finite(non_specular.samples);
}
bool is_sound(const film::NonSpecularDetails& details) {
  return is_finite(details.uv) && is_finite(details.emission) && is_finite(details.segments) &&
         is_finite(details.object) && is_finite(details.face);
}

// Throws `invalid_argument`, which names the plane as `what`, for a value that is not finite or out of range.
template <class Value>
void check_plane(const std::vector<Value>& plane, const std::string& what) {
  constexpr size_t kPixels = 4096;  // pixels per task
  std::atomic<bool> sound{true};
  tbb::parallel_for(tbb::blocked_range<size_t>(0, plane.size(), kPixels), [&](const tbb::blocked_range<size_t>& range) {
    for (size_t i = range.begin(); i < range.end(); ++i) {
      if (!is_sound(plane[i])) sound = false;
    }
  });
  if (!sound) throw invalid_argument("it holds " + what + " that no pixel has");
}

// Checks the values that the library does not check again when it uses them: the planes for passes of components, and
// all channels.
void check_planes(const film::Film& film) {
  for (const film::ComponentPlanes& planes : film.components) {
    for (const auto& half : planes.non_specular) check_plane(half, "first non-specular vertices");
    check_plane(planes.details, "details of vertices");
    check_plane(planes.motion, "motion");
    check_plane(planes.tracked, "causes of lost motion");
    check_plane(planes.shown, "shown points");
  }
  for (const film::Channel& channel : film.channels) {
    for (const std::vector<float>& half : channel.values) check_plane(half, "values of " + channel.info.name);
    check_plane(channel.weight, "weights of " + channel.info.name);
  }
}

Imf::MultiPartInputFile open_file(const std::string& path) {
  constexpr int kNoThreads = 0;  // The threads of the caller unpack.
  constexpr bool kRepair = false;
  return Imf::MultiPartInputFile(path.c_str(), kNoThreads, kRepair);
}

int number_of(const Imf::MultiPartInputFile& file, const std::string& part) {
  for (int i = 0; i < file.parts(); ++i) {
    if (file.header(i).hasName() && file.header(i).name() == part) return i;
  }
  throw invalid_argument("part " + part + " is missing");
}

// Reads a film. only: name of the only component to read; nullptr: all components.
film::Film read_film(const std::string& path, StoredContent content, const std::string* only,
                     const CancelCheck& cancel) {
  Imf::MultiPartInputFile file = open_file(path);
  film::Film film = make_film(file.header(0), content, only);
  const std::vector<StoredPart> parts = stored_parts(film::planes_of(&film, plane_names_of(file.header(0))));
  const bool is_whole = content == StoredContent::kAll && only == nullptr;
  if (is_whole && size_t(file.parts()) != parts.size()) throw invalid_argument("it has parts of something else");
  std::vector<int> numbers;
  for (const StoredPart& part : parts) {
    numbers.push_back(number_of(file, part.name));
    check_part(file.header(numbers.back()), file.header(0), part);
  }
  read_blocks(&file, PartRows(parts, film), numbers, cancel);
  check_correspondences(film);
  check_planes(film);
  return film;
}

// Returns read(), which reads the file at `path`. Errors get the path as a prefix.
template <class Read>
auto load(const std::string& path, const Read& read) {
  try {
    return read();
  } catch (const Error& e) {
    if (e.code() == GRADUS_ERROR_CANCELLED) throw;
    throw Error(e.code(), "cannot load film " + path + ": " + e.what());
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& e) {
    throw invalid_argument("cannot load film " + path + ": " + exr_problem(e));
  }
}

}  // namespace

void save_film(const film::Film& film, const std::string& path, const FilmWriteOptions& how) {
  const std::vector<StoredPart> parts = stored_parts(film::planes_of(film));
  const auto write = [&](WriterStream* stream) {
    BlockFile file(make_headers(film, parts), stream);
    write_blocks(PartRows(parts, film), how.cancel, &file);
    file.finish();
  };
  write_exr(path, write, how.durable);
}

std::shared_ptr<film::Film> load_film(const std::string& path, StoredContent content, const CancelCheck& cancel) {
  return load(path, [&] { return std::make_shared<film::Film>(read_film(path, content, nullptr, cancel)); });
}

std::shared_ptr<film::Film> load_component(const std::string& path, const std::string& name, StoredContent content,
                                           const CancelCheck& cancel) {
  auto film = load(path, [&] { return std::make_shared<film::Film>(read_film(path, content, &name, cancel)); });
  film::select_component(name, film.get());
  return film;
}

film::FilmHeader load_header(const std::string& path) {
  return load(path, [&] { return read_header(open_file(path).header(0)); });
}

std::string frame_name(int32_t frame, const char* ending) {
  std::array<char, 40> name{};
  std::snprintf(name.data(), name.size(), "f%+08d.%s", frame, ending);
  return name.data();
}

}  // namespace gradus::film_io
