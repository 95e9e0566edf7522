// The headers of a stored film: sizes, channels, and a JSON description with keys, settings, samples and format
// version.
#pragma once

#include <vector>

#include <ImfHeader.h>

#include "film/film.h"
#include "film/planes.h"
#include "film_io/store.h"
#include "film_io/store_planes.h"

namespace gradus::film_io {

// Returns one header for each part; the first contains the description.
std::vector<Imf::Header> make_headers(const film::Film& film, const std::vector<StoredPart>& parts);

// Reads the description from the first header. All functions throw Error with the problem: not a film, another version,
// larger than the memory.
film::FilmHeader read_header(const Imf::Header& header);
// Returns which names the planes have in the format in which the film is stored.
film::PlaneNames plane_names_of(const Imf::Header& header);
// Returns a film with zeroed planes. `only` is the single component with planes; nullptr: all have planes.
film::Film make_film(const Imf::Header& header, StoredContent content, const std::string* only = nullptr);
// Throws Error unless the header is one that make_headers() makes for the part.
void check_part(const Imf::Header& header, const Imf::Header& first, const StoredPart& part);

}  // namespace gradus::film_io
