// Stores films in OpenEXR files with all sums, counts and half-buffers, so that they can be reconstructed, merged and
// continued later.
#pragma once

#include <memory>
#include <string>

#include "base/cancel_check.h"
#include "film/film_header.h"
#include "film_io/file_writer.h"

namespace gradus::film_io {

// Options of save_film(), which uses the threads of the caller's task arena.
//
// Several threads call `cancel` for each block. A cancelled call throws the Error CANCELLED, writes no file and keeps
// an existing one.
struct FilmWriteOptions {
  Durable durable = Durable::kYes;
  CancelCheck cancel = [] { return false; };
};
// Writes the file atomically: under a temporary name beside it, synced, then renamed. Throws Error with path and cause.
void save_film(const film::Film& film, const std::string& path, const FilmWriteOptions& how = {});

// The content to read: everything, or only samples, which gives a film without gradients and passes.
enum class StoredContent { kAll, kSamples };
// All throw invalid_argument with path and cause for a file that is missing, damaged or no film.
std::shared_ptr<film::Film> load_film(
    const std::string& path, StoredContent content = StoredContent::kAll,
    const CancelCheck& cancel = [] { return false; });
// Loads one component only, black if the film has none of that name. It replays by its own pixel
// correspondence. Other components are not unpacked.
std::shared_ptr<film::Film> load_component(const std::string& path, const std::string& name, StoredContent content,
                                           const CancelCheck& cancel);
film::FilmHeader load_header(const std::string& path);

// Returns the file name of a frame in a folder of stored films, such as "f+0000017.fresh.exr". `ending` follows the
// number.
std::string frame_name(int32_t frame, const char* ending);

}  // namespace gradus::film_io
