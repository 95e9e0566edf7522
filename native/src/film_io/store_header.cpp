#include "film_io/store_header.h"

#include <algorithm>

#include <ImfChannelList.h>
#include <ImfPartType.h>
#include <ImfStringAttribute.h>
#include <nlohmann/json.hpp>

#include "base/clock.h"
#include "base/error.h"
#include "film/counter_fields.h"
#include "film/film.h"
#include "film/pixel_blocks.h"
#include "film/planes.h"
#include "film_io/exr_stream.h"
#include "schema/options.h"
#include "schema/pass_table.h"

namespace gradus::film_io {
namespace {

using nlohmann::json;

// Format that is written, and the oldest one that is read. Films of the formats 9 and 10 hold their counters as a list.
// Films of the formats before kFormatOfCurrentNames have the older names of planes.
constexpr int kFormat = 12, kOldestFormat = 9, kFormatOfCurrentNames = 12;
constexpr size_t kMaxStoredComponents = 64;
constexpr const char* kAttribute = "gradus";

// Returns the exception that load_film() throws for a file with this problem.
Error damaged(const std::string& why) { return invalid_argument(why); }

std::string hex(uint64_t value) {
  char text[20];
  std::snprintf(text, sizeof(text), "%016llx", static_cast<unsigned long long>(value));
  return text;
}

json counters_to_json(const film::Counters& counters) {
  json j = json::object();
  for (const film::CounterField& field : film::kCounterFields)
    j[json::json_pointer(field.path)] = counters.*field.value;
  return j;
}

uint64_t key_from_json(const json& j) { return std::stoull(j.get<std::string>(), nullptr, 16); }

film::Counters counters_from_json(const json& j) {
  film::Counters counters;
  const std::vector<uint64_t> listed = j.is_array() ? j.get<std::vector<uint64_t>>() : std::vector<uint64_t>();
  for (size_t i = 0; i < std::size(film::kCounterFields); ++i) {
    const film::CounterField& field = film::kCounterFields[i];
    if (i < listed.size()) counters.*field.value = listed[i];  // of an older film
    if (j.is_object()) counters.*field.value = j.value(json::json_pointer(field.path), uint64_t{0});
  }
  return counters;
}

json ranges_to_json(const film::SampleRanges& ranges) {
  json list = json::array();
  for (const film::SampleRange& r : ranges.list()) list.push_back({r.begin, r.end});
  return list;
}

json rotation_to_json(const Mat3& m) {
  json list = json::array();
  for (int i = 0; i < 9; ++i) list.push_back(m[i / 3][i % 3]);
  return list;
}

// Returns a rotation from the numbers of its columns, or the identity for films of older versions, which have none.
Mat3 rotation_from_json(const json& description, const char* name) {
  Mat3 m(1.0f);
  if (!description.contains(name)) return m;
  const json& list = description.at(name);
  for (int i = 0; i < 9; ++i) m[i / 3][i % 3] = list.at(size_t(i)).get<float>();
  return m;
}

film::SampleRanges ranges_from_json(const json& j) {
  std::vector<film::SampleRange> list;
  for (const json& r : j) list.push_back({r.at(0).get<uint32_t>(), r.at(1).get<uint32_t>()});
  return film::SampleRanges(std::move(list));
}

json adaptive_state_to_json(const film::AdaptiveState& shared) {
  return {{"mean", shared.mean}, {"uncounted", shared.uncounted}, {"rays", shared.rays}, {"stopped", shared.stopped}};
}

film::AdaptiveState adaptive_state_from_json(const json& j, const Region& region) {
  film::AdaptiveState shared{j.at("mean"), j.value("uncounted", 0u), j.at("rays").get<std::vector<uint64_t>>(),
                             j.at("stopped").get<std::vector<uint8_t>>()};
  const size_t blocks = film::make_pixel_blocks(region).size();
  if (shared.rays.size() != blocks || shared.stopped.size() != blocks) throw damaged("its pixel blocks are wrong");
  return shared;
}

json components_to_json(const film::Film& film) {
  json list = json::array();
  for (const film::ComponentPlanes& planes : film.components) list.push_back({planes.name, planes.expression});
  return list;
}

void name_components(const json& list, film::Film* film) {
  for (size_t i = 0; i < film->components.size(); ++i) {
    film->components[i].name = list.at(i).at(0);
    film->components[i].expression = list.at(i).at(1);
  }
}

film::ComponentContent component_content_from_json(const json& j) {
  // Older films have no details, and the key "rough" in place of "non_specular".
  return {j.at(j.contains("rough") ? "rough" : "non_specular"), j.value("details", false), j.at("motion"),
          j.at("shown")};
}

// Describes all channels in their order. The sums of splats are divided by the paths, which are stored with them.
json channels_to_json(const film::ChannelList& channels) {
  json list = json::array();
  for (const film::Channel& channel : channels) {
    const film::ChannelInfo& info = channel.info;
    list.push_back({{"name", info.name},
                    {"values", info.values_per_pixel},
                    {"type", info.type},
                    {"normalisation", info.normalisation},
                    {"halves", info.in_halves},
                    {"splats", info.takes_splats},
                    {"paths", channel.paths}});
  }
  return list;
}

// Returns whether a film needs the full description: a list of passes does not describe its channels.
bool has_other_channels(const film::Film& film) {
  return std::ranges::any_of(film.channels,
                             [](const film::Channel& channel) { return channel.pass == GRADUS_PASS_COUNT; });
}

template <class Enum>
Enum enum_from_json(const json& j, Enum last) {
  const int value = j;
  if (value < 0 || value > int(last)) throw damaged("its channels are of an unknown type");
  return Enum(value);
}

std::vector<film::ChannelInfo> channels_from_json(const json& list) {
  std::vector<film::ChannelInfo> channels;
  for (const json& j : list) {
    channels.push_back({j.at("name"), j.at("values"), enum_from_json(j.at("type"), film::ValueType::kIdAndWeight),
                        enum_from_json(j.at("normalisation"), film::Normalisation::kFirstSample), j.at("halves"),
                        j.at("splats")});
  }
  return channels;
}

// Returns the channels of a stored film. A film that has none but passes lists these as bits. Bits of older films lack
// the pass Fallback.
std::vector<film::ChannelInfo> stored_channels(const json& description, const film::FilmHeader& known) {
  if (const auto list = description.find("channel_list"); list != description.end()) return channels_from_json(*list);
  return film::channels_of_passes(known.planes | (known.settings.passes & uint64_t{1} << GRADUS_PASS_FALLBACK));
}

json describe_samples(const film::Film& film) {
  const film::ComponentContent kept = film::component_content(film);
  return {{"format", kFormat},
          {"version", gradus_version_text()},
          {"frame", film.frame_number},
          {"channels", film.color_channels},
          {"components", components_to_json(film)},
          {"non_specular", kept.non_specular},
          {"details", kept.details},
          {"motion", kept.motion},
          {"shown", kept.shown},
          {"gradients", film.gradients},
          {"sampling_key", hex(schema::sampling_key(film.settings))},
          {"scene_key", hex(film.scene_key)},
          {"view_rotation", rotation_to_json(film.view_rotation)},
          {"settings", schema::settings_to_json(film.settings)},
          {"planes", film.channels.passes()},
          {"samples", ranges_to_json(film.samples)},
          {"counters", counters_to_json(film.counters)}};
}

json describe(const film::Film& film) {
  json j = describe_samples(film);
  if (has_other_channels(film)) j["channel_list"] = channels_to_json(film.channels);
  if (!film.shared.rays.empty()) j["shared"] = adaptive_state_to_json(film.shared);
  if (film.replayed.correspondence.empty()) return j;
  j["replayed_frame"] = film.replayed.stream_frame;
  j["replayed_scene_key"] = hex(film.replayed.scene_key);
  j["replayed_seed"] = film.replayed.seed;
  j["replayed_net_samples"] = film.replayed.net_samples;
  j["off_centre"] = !film.replayed.correspondence.off_centre.empty();
  for (int c = 0; c < int(film.components.size()); ++c) {
    if (film.replayed.has_component_map(c)) j["component_maps"].push_back(c);
  }
  return j;
}

Imf::PixelType type_of(const StoredPlane& plane) { return plane.integer ? Imf::UINT : Imf::FLOAT; }

Imf::Header make_header(const film::Film& film, const StoredPart& part) {
  const int width = int(film.full_width), height = int(film.full_height);
  const Region& r = film.region;
  // OpenEXR's rows run downwards.
  const Imath::Box2i display({0, 0}, {width - 1, height - 1});
  const Imath::Box2i data({r.x0, height - r.y1}, {r.x1 - 1, height - 1 - r.y0});
  Imf::Header header(display, data);
  header.setName(part.name);
  header.compression() = Imf::ZIP_COMPRESSION;
  for (const StoredPlane& plane : part.planes) header.channels().insert(plane.name, Imf::Channel(type_of(plane)));
  return header;
}

json description_of(const Imf::Header& header) {
  const auto* attribute = header.findTypedAttribute<Imf::StringAttribute>(kAttribute);
  if (!attribute) throw damaged("it is not a film of Gradus");
  json description = json::parse(attribute->value());
  const int format = description.at("format");
  if (format < kOldestFormat || format > kFormat) throw damaged("it was written by another version of Gradus");
  return description;
}

void check_size(const Imath::Box2i& display, const Imath::Box2i& data) {
  const auto inside = [](int low, int high, int end) { return low >= 0 && low <= high && high < end; };
  if (display.min.x != 0 || display.min.y != 0 || display.max.x < 0 || display.max.x >= kMaxImageSide ||
      display.max.y < 0 || display.max.y >= kMaxImageSide || !inside(data.min.x, data.max.x, display.max.x + 1) ||
      !inside(data.min.y, data.max.y, display.max.y + 1)) {
    throw damaged("its size is wrong");
  }
}

void check_regions(const film::Film& film) {
  const uint32_t* r = film.settings.region;
  const bool whole = r[0] == 0 && r[1] == 0 && r[2] == 0 && r[3] == 0;
  const Region delivered{int32_t(r[0]), int32_t(r[1]), int32_t(r[2]), int32_t(r[3])};
  if (!whole && (r[2] > film.full_width || r[3] > film.full_height || delivered.x0 < film.region.x0 ||
                 delivered.y0 < film.region.y0 || delivered.x1 > film.region.x1 || delivered.y1 > film.region.y1 ||
                 delivered.width() <= 0 || delivered.height() <= 0)) {
    throw damaged("its region lies outside of it");
  }
  if (film.settings.width != film.full_width || film.settings.height != film.full_height)
    throw damaged("its settings name another size");
}

Region region_of(const Imf::Header& header) {
  const Imath::Box2i &display = header.displayWindow(), &data = header.dataWindow();
  check_size(display, data);
  const int height = display.max.y + 1;
  return {data.min.x, height - 1 - data.max.y, data.max.x + 1, height - data.min.y};
}

film::FilmHeader read_header(const Imf::Header& header, const json& description) {
  film::FilmHeader film;
  film.region = region_of(header);
  film.color_channels = description.at("channels");
  if (film.color_channels != 3 && film.color_channels != 4) throw damaged("its number of colour channels is wrong");
  film.gradients = description.at("gradients");
  film.planes = description.at("planes");
  film.of_components = component_content_from_json(description);
  film.settings = schema::settings_from_json(description.at("settings"), &film.warnings);
  film.samples = ranges_from_json(description.at("samples"));
  film.replayed_frame = description.value("replayed_frame", 0);
  if (description.contains("replayed_scene_key"))
    film.replayed_key = key_from_json(description.at("replayed_scene_key"));
  film.replayed_seed =
      description.value("replayed_seed", film.settings.seed);  // older films replay with the seed of their own frame
  film.replayed_net_samples = description.value("replayed_net_samples", 0u);
  if (description.contains("shared")) film.shared = adaptive_state_from_json(description.at("shared"), film.region);
  film.scene_key = key_from_json(description.at("scene_key"));
  film.frame_number = description.at("frame");
  film.view_rotation = rotation_from_json(description, "view_rotation");
  return film;
}

// Returns the number of a component, or 0 if there is none of that name: select_component() then makes it black.
size_t place_of(const json& names, const std::string& name) {
  const auto found = std::find_if(names.begin(), names.end(), [&](const json& item) { return item.at(0) == name; });
  return found != names.end() ? size_t(found - names.begin()) : 0;
}

// Moves the only component of the film to `place` among `count` components. The others have no planes.
void place_component(size_t place, size_t count, film::Film* film) {
  std::vector<film::ComponentPlanes> components(count);
  components[place] = std::move(film->components.front());
  film->components = std::move(components);
}

}  // namespace

std::vector<Imf::Header> make_headers(const film::Film& film, const std::vector<StoredPart>& parts) {
  std::vector<Imf::Header> headers;
  headers.reserve(parts.size());
  for (const StoredPart& part : parts) headers.push_back(make_header(film, part));
  headers.front().insert(kAttribute, Imf::StringAttribute(describe(film).dump()));
  return headers;
}

film::FilmHeader read_header(const Imf::Header& header) { return read_header(header, description_of(header)); }

film::PlaneNames plane_names_of(const Imf::Header& header) {
  const int format = description_of(header).at("format");
  return format < kFormatOfCurrentNames ? film::PlaneNames::kOlder : film::PlaneNames::kCurrent;
}

film::Film make_film(const Imf::Header& header, StoredContent content, const std::string* only) {
  const json description = description_of(header);
  const film::FilmHeader known = read_header(header, description);
  const json& names = description.at("components");
  if (!names.is_array() || names.empty() || names.size() > kMaxStoredComponents)
    throw damaged("its list of components is wrong");
  const int components = int(names.size());
  const bool is_whole = content == StoredContent::kAll, gradients = is_whole && known.gradients;
  const film::ComponentContent kept = is_whole ? known.of_components : film::ComponentContent{};
  const auto pixels = uint64_t(known.region.area());
  std::vector<film::ChannelInfo> channels;
  if (is_whole) channels = stored_channels(description, known);
  const int held = only ? 1 : components;
  const uint64_t bytes = film::film_bytes_per_pixel(held, gradients, channels, kept) * pixels,
                 available = machine_memory_bytes();
  if (available > 0 && bytes > available) throw Error(GRADUS_ERROR_OUT_OF_MEMORY, "it is larger than the memory");

  const Imath::V2i last = header.displayWindow().max;
  film::Film film(uint32_t(last.x + 1), uint32_t(last.y + 1), known.region, known.color_channels, held, gradients);
  film::allocate_component_content(kept, &film);
  if (only) place_component(place_of(names, *only), names.size(), &film);
  name_components(names, &film);
  film.settings = known.settings;
  film.frame_number = known.frame_number;
  film.view_rotation = known.view_rotation;
  film.scene_key = known.scene_key;
  film.counters = counters_from_json(description.at("counters"));
  film.samples = known.samples;
  film.shared = known.shared;
  for (const film::ChannelInfo& info : channels) film.channels.add(info, pixels);
  if (const uint64_t passes = film.channels.passes(); schema::needed_passes(passes) != passes)
    throw damaged("a light pass lacks the colour that divides it");
  if (is_whole && description.contains("channel_list")) {
    for (size_t i = 0; i < film.channels.size(); ++i)
      film.channels[i].paths = description.at("channel_list").at(i).at("paths");
  }
  if (description.contains("replayed_frame")) {
    const film::PixelCorrespondence correspondence{
        std::vector<int32_t>(pixels), std::vector<Vec2>(description.value("off_centre", false) ? pixels : 0)};
    film.replayed = {known.replayed_frame, correspondence, known.replayed_key, known.replayed_seed};
    film.replayed.net_samples = known.replayed_net_samples;
    // Older films have the key "own_sources".
    const char* const key = description.contains("own_sources") ? "own_sources" : "component_maps";
    for (const int own : description.value(key, std::vector<int>())) {
      if (own < 0 || own >= components) throw damaged("a replay map belongs to no component");
      if (film.components[size_t(own)].primal[0].empty()) continue;  // The component is not read.
      film.replayed.of_component.resize(size_t(components));
      film.replayed.of_component[size_t(own)] = correspondence;
    }
  }
  check_regions(film);
  return film;
}

void check_part(const Imf::Header& header, const Imf::Header& first, const StoredPart& part) {
  if (!header.hasName() || header.name() != part.name) throw damaged("part " + part.name + " is missing");
  if (!header.hasType() || header.type() != Imf::SCANLINEIMAGE)
    throw damaged("part " + part.name + " is no image of scan lines");
  if (header.dataWindow() != first.dataWindow()) throw damaged("its parts differ in size");
  for (const StoredPlane& plane : part.planes) {
    const Imf::Channel* channel = header.channels().findChannel(plane.name);
    if (!channel || channel->type != type_of(plane) || channel->xSampling != 1 || channel->ySampling != 1) {
      throw damaged("channel " + plane.name + " is missing or of another type");
    }
  }
  size_t channels = 0;
  for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel) ++channels;
  if (channels != part.planes.size()) throw damaged("it has channels of something else");
  if (header.compression() != Imf::ZIP_COMPRESSION) throw damaged("it was packed by another program");
}

}  // namespace gradus::film_io
