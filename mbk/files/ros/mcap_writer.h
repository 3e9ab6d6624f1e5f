#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"

namespace mbk::recording {

/// A message of ROS 2 as plain CDR, field by field.
class CdrMessage {
 public:
  void add(double value);
  void add(std::int32_t value);
  void add(std::uint32_t value);
  void add(std::string_view text);
  /// @param stamp  [ns]
  void add_header(std::int64_t stamp, std::string_view frame);
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  template <class Number>
  void put(Number value);
  std::string bytes_{'\0', '\1', '\0', '\0'};
};

/// Puts an MCAP file together: chunks packed by zstd, checksums, an index and statistics, as viewers want them.
class McapWriter {
 public:
  explicit McapWriter(std::string_view library);

  /// The number of a new channel of CDR messages.
  [[nodiscard]] std::uint16_t add_channel(std::string_view topic, std::string_view type, std::string_view definition);
  void add_metadata(std::string_view name, const std::map<std::string, std::string>& pairs);
  /// @param time  [ns], ≥ 0
  /// @fails  as `finish`
  [[nodiscard]] Result<void> add_message(std::uint16_t channel, std::int64_t time, std::string_view message);
  /// The bytes of the file.
  /// @fails  data: a chunk cannot be packed
  [[nodiscard]] Result<std::string> finish();

 private:
  struct Channel {
    std::uint64_t messages = 0;
    std::uint32_t sequence = 0;
    std::vector<std::pair<std::uint64_t, std::uint64_t>> index;  ///< of the open chunk: time, offset
  };
  Result<void> close_chunk();

  std::string file_, chunk_;
  std::string descriptions_;  ///< records of schemas and channels
  std::string chunk_indexes_, metadata_indexes_;
  std::vector<Channel> channels_;
  std::uint64_t chunk_first_ = 0, chunk_last_ = 0, first_ = 0, last_ = 0, messages_ = 0;  ///< times [ns], and a count
  std::uint32_t chunks_ = 0, metadata_ = 0;
};

}  // namespace mbk::recording
