#include "frame/block_file.h"

#include <ImfChannelList.h>
#include <ImfVersion.h>

namespace gradus {
namespace {

constexpr size_t kShortName = 31;

bool has_long_names(const Imf::Header& header) {
  for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel) {
    if (std::string(channel.name()).size() > kShortName) return true;
  }
  return false;
}

}  // namespace

BlockFile::BlockFile(const Imf::Header& header, WriterStream* stream) : stream_(stream), row_(header.dataWindow().min.y) {
  header.sanityCheck();
  put(int32_t{Imf::MAGIC});
  put(int32_t{Imf::EXR_VERSION | (has_long_names(header) ? Imf::LONG_NAMES_FLAG : 0)});
  header.writeTo(*stream);
  table_ = stream->tellp();
  const int rows = header.dataWindow().max.y - header.dataWindow().min.y + 1;
  const std::vector<uint64_t> empty(size_t(rows + kBlockRows - 1) / kBlockRows);
  for (const uint64_t place : empty) put(place);
}

void BlockFile::write(const Bytes& packed) {
  places_.push_back(stream_->tellp());
  put(int32_t{row_});
  put(static_cast<int32_t>(packed.size()));
  stream_->write(reinterpret_cast<const char*>(packed.data()), int(packed.size()));
  row_ += kBlockRows;
}

void BlockFile::finish() {
  const uint64_t end = stream_->tellp();
  stream_->seekp(table_);
  for (const uint64_t place : places_) put(place);
  stream_->seekp(end);
}

}  // namespace gradus
