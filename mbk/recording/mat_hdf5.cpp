#include "mbk/recording/mat_hdf5.h"

#include <fmt/format.h>
#include <hdf5.h>
#include <zlib.h>

#include <cstring>
#include <mutex>

#include "mbk/recording/byte_view.h"
#include "mbk/recording/file_bytes.h"
#include "mbk/recording/utf16.h"

namespace mbk::recording {
namespace {

constexpr std::size_t kUserBlock = 512;  ///< MATLAB's header before the HDF5 data
constexpr int kDeepest = 16;
constexpr int kMostObjects = 100'000;  ///< groups can contain each other: a damaged file must not keep us for ever
constexpr unsigned char kSignature[8] = {0x89, 'H', 'D', 'F', '\r', '\n', 0x1a, '\n'};

constexpr auto kRemedy = "the file is damaged or cut short: copy it again from where it was recorded";

/// After a damaged file the library complains when the program ends. Everything is closed here, so it need not act
/// then.
[[maybe_unused]] const herr_t kNoExitHandler = H5dont_atexit();

/// An HDF5 identifier that closes itself.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  operator hid_t() const { return id_; }
  [[nodiscard]] bool ok() const { return id_ >= 0; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// Keeps the library from printing its errors.
class Quiet {
 public:
  Quiet() {
    H5Eget_auto2(H5E_DEFAULT, &print_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  Quiet(const Quiet&) = delete;
  Quiet& operator=(const Quiet&) = delete;
  ~Quiet() { H5Eset_auto2(H5E_DEFAULT, print_, data_); }

 private:
  H5E_auto2_t print_ = nullptr;
  void* data_ = nullptr;
};

/// The file's length that its superblock claims (HDF5 File Format Specification 3.0, II.A), or nothing where the
/// superblock is not possible.
Result<std::uint64_t> claimed_end(ByteView superblock) {
  const auto fail = [] { return bad_data("its HDF5 superblock is broken", kRemedy); };
  if (!superblock.holds(0, 96)) return fail();
  const auto version = superblock.at<std::uint8_t>(8);
  if (version > 3) return fail();
  const bool old = version < 2;
  const auto offset_size = superblock.at<std::uint8_t>(old ? 13 : 9);
  if (offset_size != 8) return fail();
  const std::size_t addresses = version == 0 ? 24 : version == 1 ? 28 : 12;
  return superblock.at<std::uint64_t>(addresses + 2 * std::size_t{offset_size});
}

std::string text_attribute(hid_t object, const char* name) {
  if (H5Aexists(object, name) <= 0) return {};
  const Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
  if (!attribute.ok()) return {};
  const Handle type(H5Aget_type(attribute), H5Tclose);
  const Handle space(H5Aget_space(attribute), H5Sclose);
  if (!type.ok() || !space.ok() || H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) != 0) return {};
  const std::size_t size = H5Tget_size(type);
  if (H5Sget_simple_extent_npoints(space) != 1 || size > 256) return {};
  std::string text(size, '\0');
  if (H5Aread(attribute, type, text.data()) < 0) return {};
  return printable(text.c_str());
}

bool is_numeric_class(std::string_view name) {
  return name == "double" || name == "single" || name == "logical" || name.starts_with("int") ||
         name.starts_with("uint");
}

/// Whether numbers are stored as processors do. HDF5 1.10 writes beyond its buffers where a damaged file describes
/// others.
bool is_ordinary_number(hid_t type) {
  for (const hid_t ordinary :
       {H5T_IEEE_F64LE, H5T_IEEE_F64BE, H5T_IEEE_F32LE, H5T_IEEE_F32BE, H5T_STD_I8LE,  H5T_STD_U8LE,  H5T_STD_I8BE,
        H5T_STD_U8BE,   H5T_STD_I16LE,  H5T_STD_U16LE,  H5T_STD_I16BE,  H5T_STD_U16BE, H5T_STD_I32LE, H5T_STD_U32LE,
        H5T_STD_I32BE,  H5T_STD_U32BE,  H5T_STD_I64LE,  H5T_STD_U64LE,  H5T_STD_I64BE, H5T_STD_U64BE}) {
    if (H5Tequal(type, ordinary) > 0) return true;
  }
  return false;
}

enum class Filters { none, deflate, other };

/// How a chunked dataset is packed; shuffling does not change its size.
Filters filters_of(hid_t properties) {
  Filters found = Filters::none;
  for (int i = 0; i < H5Pget_nfilters(properties); ++i) {
    unsigned flags = 0;
    std::size_t values = 0;
    const auto filter =
        H5Pget_filter2(properties, static_cast<unsigned>(i), &flags, &values, nullptr, 0, nullptr, nullptr);
    if (filter == H5Z_FILTER_DEFLATE && found == Filters::none) {
      found = Filters::deflate;
    } else if (filter != H5Z_FILTER_SHUFFLE) {
      return Filters::other;
    }
  }
  return found;
}

/// Whether a chunk holds exactly so many bytes. HDF5 1.10 does not ask, and reads beyond what it inflated.
bool chunk_is_whole(hid_t dataset, hid_t space, hsize_t index, std::uint64_t chunk_bytes, bool deflated) {
  hsize_t offset[2] = {};
  unsigned skipped_filters = 0;
  haddr_t address = 0;
  hsize_t stored = 0;
  if (H5Dget_chunk_info(dataset, space, index, offset, &skipped_filters, &address, &stored) < 0) return false;
  if (skipped_filters != 0 || stored > compressBound(chunk_bytes)) return false;
  if (!deflated) return stored == chunk_bytes;
  Buffer packed(stored);
  Buffer whole(chunk_bytes);
  std::uint32_t mask = 0;
  if (H5Dread_chunk(dataset, H5P_DEFAULT, offset, &mask, packed.data.get()) < 0) return false;
  uLongf size = chunk_bytes;
  return uncompress(reinterpret_cast<Bytef*>(whole.data.get()), &size,
                    reinterpret_cast<const Bytef*>(packed.data.get()), stored) == Z_OK &&
         size == chunk_bytes;
}

/// Whether every number is in the file: HDF5 reads what was never written as zeros.
bool is_whole(hid_t dataset, hid_t space, const hsize_t (&size)[2], std::size_t each, std::uint64_t limit) {
  const Handle properties(H5Dget_create_plist(dataset), H5Pclose);
  if (!properties.ok()) return false;
  if (H5Pget_layout(properties) != H5D_CHUNKED) return H5Dget_storage_size(dataset) >= size[0] * size[1] * each;
  hsize_t chunk[2] = {};
  if (H5Pget_chunk(properties, 2, chunk) != 2 || chunk[0] == 0 || chunk[1] == 0) return false;
  const Filters filters = filters_of(properties);
  std::uint64_t chunk_bytes = 0;
  if (__builtin_mul_overflow(chunk[0], chunk[1], &chunk_bytes) ||
      __builtin_mul_overflow(chunk_bytes, each, &chunk_bytes) || chunk_bytes > limit || filters == Filters::other) {
    return false;
  }
  const auto along = [&](int i) { return (size[i] - 1) / chunk[i] + 1; };
  hsize_t chunks = 0;
  if (H5Dget_num_chunks(dataset, space, &chunks) < 0 || chunks != along(0) * along(1)) return false;
  for (hsize_t i = 0; i < chunks; ++i) {
    if (!chunk_is_whole(dataset, space, i, chunk_bytes, filters == Filters::deflate)) return false;
  }
  return true;
}

class Decoder {
 public:
  explicit Decoder(std::uint64_t file_size) : file_size_(file_size) {}
  Contents contents;

  Result<void> group(hid_t group, const std::string& prefix, int depth) {
    H5G_info_t info{};
    if (depth > kDeepest) return bad_data("structures are nested too deeply", kRemedy);
    if (H5Gget_info(group, &info) < 0) return bad_data("a group cannot be read", kRemedy);
    for (hsize_t i = 0; i < info.nlinks; ++i) {
      char name[1024] = {};
      if (H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, i, name, sizeof name, H5P_DEFAULT) < 0) {
        return bad_data("a name cannot be read", kRemedy);
      }
      H5L_info_t link{};
      if (H5Lget_info(group, name, &link, H5P_DEFAULT) < 0) return bad_data("a link cannot be read", kRemedy);
      if (name[0] == '#' || link.type != H5L_TYPE_HARD) continue;  // MATLAB's own; never other files
      if (++objects_ > kMostObjects) return bad_data(fmt::format("more than {} variables", kMostObjects), kRemedy);
      const std::string full = prefix.empty() ? printable(name) : prefix + "." + printable(name);
      const Handle object(H5Oopen(group, name, H5P_DEFAULT), H5Oclose);
      if (!object.ok()) return bad_data("cannot be opened", kRemedy, fmt::format("variable '{}'", full));
      if (auto done = variable(object, full, depth); !done) return done;
    }
    return {};
  }

 private:
  Result<void> variable(hid_t object, const std::string& name, int depth) {
    const std::string type = text_attribute(object, "MATLAB_class");
    const auto kind = H5Iget_type(object);
    if (H5Aexists(object, "MATLAB_object_decode") > 0) {
      return aside(name, type == "function_handle"
                             ? "a function handle"
                             : fmt::format("an object of MATLAB class '{}', which only MATLAB can read", type));
    }
    if (H5Aexists(object, "MATLAB_sparse") > 0) return aside(name, "a sparse matrix");
    if (kind == H5I_GROUP) return group(object, name, depth + 1);
    if (kind != H5I_DATASET) return aside(name, "not a matrix");
    if (H5Aexists(object, "MATLAB_empty") > 0) return {};
    if (type == "char") return text(object, name);
    if (type == "cell") return aside(name, "a cell array");
    if (type.empty() || is_numeric_class(type)) return dataset(object, name);
    return aside(name, fmt::format("of class '{}'", type));
  }

  /// Text is stored as the numbers of its UTF-16 code units. It is read where it is one line.
  Result<void> text(hid_t object, const std::string& name) {
    const std::size_t before = contents.arrays.size();
    if (auto done = dataset(object, name); !done) return done;
    if (contents.arrays.size() == before) return {};
    const Matrix units = std::move(contents.arrays.back().values);
    contents.arrays.pop_back();
    const bool are_units = (units.array() >= 0.0 && units.array() <= 65535.0).all();
    if (units.rows() != 1 || !are_units) return aside(name, "text in a way that is not read");
    std::u16string line;
    for (const double unit : units.reshaped()) line += static_cast<char16_t>(unit);
    contents.texts.push_back({name, {printable(utf8_from_utf16(line))}});
    return {};
  }

  Result<void> dataset(hid_t dataset, const std::string& name) {
    const auto damaged = [&](std::string what) {
      return bad_data(std::move(what), kRemedy, fmt::format("variable '{}'", name));
    };
    const Handle type(H5Dget_type(dataset), H5Tclose);
    const Handle space(H5Dget_space(dataset), H5Sclose);
    if (!type.ok() || !space.ok()) return damaged("its type cannot be read");
    const auto type_class = H5Tget_class(type);
    if (type_class == H5T_COMPOUND) return aside(name, "complex");
    if (type_class == H5T_REFERENCE) return aside(name, "a field of a structure array");
    if (!is_ordinary_number(type)) return aside(name, "not numeric");
    const int rank = H5Sget_simple_extent_ndims(space);
    if (rank != 2) return aside(name, fmt::format("an array of {} dimensions", rank));
    hsize_t size[2] = {};
    if (H5Sget_simple_extent_dims(space, size, nullptr) != 2) return damaged("its dimensions cannot be read");
    std::uint64_t claimed = 0;
    if (__builtin_mul_overflow(size[0], size[1], &claimed) ||
        __builtin_mul_overflow(claimed, sizeof(double), &claimed) || claimed > largest_claim(file_size_) - claimed_ ||
        claimed > largest_claim(H5Dget_storage_size(dataset))) {
      return damaged(fmt::format("dimensions {}×{} are more than the file can hold", size[1], size[0]));
    }
    if (claimed > 0 && !is_whole(dataset, space, size, H5Tget_size(type), largest_claim(file_size_))) {
      return damaged("a part of it was never written, or is packed in an unknown way");
    }
    claimed_ += claimed;
    Array& array = contents.arrays.emplace_back();
    array.name = name;
    array.values.resize(static_cast<Index>(size[1]), static_cast<Index>(size[0]));
    if (claimed > 0 && H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, array.values.data()) < 0) {
      return damaged("its data cannot be read");
    }
    return {};
  }

  Result<void> aside(const std::string& name, std::string_view what) {
    contents.notes.push_back(fmt::format("variable '{}' is {}; left aside", name, what));
    return {};
  }

  std::uint64_t file_size_;
  std::uint64_t claimed_ = 0;  ///< [bytes], of all datasets so far
  int objects_ = 0;
};

}  // namespace

bool looks_like_mat_hdf5(std::span<const std::byte> file) {
  return file.size() >= kUserBlock + sizeof kSignature &&
         std::memcmp(file.data() + kUserBlock, kSignature, sizeof kSignature) == 0;
}

Result<Contents> decode_mat_hdf5(const std::filesystem::path& file, std::span<const std::byte> bytes) {
  const bool swapped = std::endian::native == std::endian::big;  // HDF5's own numbers are little-endian
  const auto end = claimed_end({bytes.subspan(kUserBlock), swapped});
  if (!end) return tl::unexpected(end.error());
  if (*end > bytes.size()) {
    return bad_data(fmt::format("the file has {} of the {} bytes that it should have", bytes.size(), *end), kRemedy);
  }
  static std::mutex one_at_a_time;  // the library is not safe for several threads
  const std::lock_guard lock(one_at_a_time);
  const Quiet quiet;
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_fclose_degree(access, H5F_CLOSE_STRONG);
  const Handle opened(H5Fopen(file.c_str(), H5F_ACC_RDONLY, access), H5Fclose);
  if (!opened.ok()) return bad_data("HDF5 cannot open it", kRemedy);
  Decoder decoder(bytes.size());
  decoder.contents.format = "MAT v7.3";
  const Handle root(H5Gopen2(opened, "/", H5P_DEFAULT), H5Gclose);
  if (!root.ok()) return bad_data("its root group cannot be read", kRemedy);
  if (auto done = decoder.group(root, "", 0); !done) return tl::unexpected(done.error());
  return std::move(decoder.contents);
}

}  // namespace mbk::recording
