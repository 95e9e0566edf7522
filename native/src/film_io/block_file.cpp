#include "film_io/block_file.h"

#include <ImfChannelList.h>
#include <ImfPartType.h>
#include <ImfVersion.h>

namespace gradus::film_io {
namespace {

constexpr size_t kShortName = 31;

bool has_long_names(const Imf::Header& header) {
  for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel) {
    if (std::string(channel.name()).size() > kShortName) return true;
  }
  return false;
}

size_t blocks_of(const Imf::Header& header) {
  const int rows = header.dataWindow().max.y - header.dataWindow().min.y + 1;
  return size_t(rows + kBlockRows - 1) / kBlockRows;
}

}  // namespace

BlockFile::BlockFile(std::vector<Imf::Header> headers, WriterStream* stream)
    : stream_(stream), top_(headers.front().dataWindow().min.y) {
  int flags = Imf::MULTI_PART_FILE_FLAG;
  for (Imf::Header& header : headers) {
    header.setType(Imf::SCANLINEIMAGE);
    header.setChunkCount(int(blocks_of(header)));
    header.sanityCheck(false, true);
    if (has_long_names(header)) flags |= Imf::LONG_NAMES_FLAG;
    places_.emplace_back(blocks_of(header));
  }
  put(int32_t{Imf::MAGIC});
  put(int32_t{Imf::EXR_VERSION | flags});
  for (const Imf::Header& header : headers) header.writeTo(*stream);
  put('\0');  // An empty header ends the list of headers.
  table_ = stream->tellp();
  put_places();
}

void BlockFile::write(int part, int block, const Bytes& packed) {
  places_[size_t(part)][size_t(block)] = stream_->tellp();
  put(int32_t{part});
  put(int32_t{top_ + kBlockRows * block});
  put(static_cast<int32_t>(packed.size()));
  stream_->write(reinterpret_cast<const char*>(packed.data()), int(packed.size()));
}

void BlockFile::put_places() {
  for (const auto& part : places_) {
    for (const uint64_t place : part) put(place);
  }
}

void BlockFile::finish() {
  const uint64_t end = stream_->tellp();
  stream_->seekp(table_);
  put_places();
  stream_->seekp(end);
}

}  // namespace gradus::film_io
