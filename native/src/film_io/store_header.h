// What stands before the planes of a stored frame: sizes and channels, and in words keys, settings, samples and the
// version of the format.
#pragma once

#include <ImfHeader.h>

#include <vector>

#include "film/film.h"
#include "film_io/store.h"
#include "film_io/store_planes.h"

namespace gradus::film_io {

// One for each part; the description is in the first.
std::vector<Imf::Header> make_headers(const film::Film& film, const std::vector<StoredPart>& parts);

// From the first part's. All throw Error with what is wrong: no frame, another version, larger than the memory.
film::FilmHeader read_header(const Imf::Header& header);
// A frame with zeroed planes. only: the component that has any; nullptr: all have.
film::Film make_frame(const Imf::Header& header, StoredContent content, const std::string* only = nullptr);
// The header of a part as make_headers() makes it.
void check_part(const Imf::Header& header, const Imf::Header& first, const StoredPart& part);

}  // namespace gradus::film_io
