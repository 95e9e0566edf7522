// Frames in files: OpenEXR with all sums, counts and halves, so that a frame can be reconstructed, merged and gone on
// from later (contract 7.2).
#pragma once

#include <memory>
#include <string>

#include "base/cancel_check.h"
#include "film/film_header.h"
#include "film_io/file_writer.h"

namespace gradus::film_io {

// By the threads of the caller's arena.
//
// `cancel` is asked by several of them, block by block: what is cancelled throws the Error CANCELLED. A file that was
// being written is not there then, and one that had the name before still has it.
struct FilmWriteOptions {
  Durable durable = Durable::kYes;
  CancelCheck cancel = [] { return false; };
};
// Writes PATH as a whole or not at all: under a temporary name beside it, synced, then renamed. Throws Error with path
// and cause.
void save_film(const film::Film& film, const std::string& path, const FilmWriteOptions& how = {});

// What is read of a file: the samples alone are a frame without gradients and passes.
enum class StoredContent { kAll, kSamples };
// All throw invalid_argument with path and cause for a file that is missing, damaged or no frame.
std::shared_ptr<film::Film> load_film(
    const std::string& path, StoredContent content = StoredContent::kAll,
    const CancelCheck& cancel = [] { return false; });
// The same of one component alone, black where the frame has none of that name: the frame's only one, which replays
// from where that component was. Nothing is unpacked of the others.
std::shared_ptr<film::Film> load_component(const std::string& path, const std::string& name, StoredContent content,
                                           const CancelCheck& cancel);
film::FilmHeader load_header(const std::string& path);

}  // namespace gradus::film_io
