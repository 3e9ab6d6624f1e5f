#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "mbk/files/contents/utf16.h"
#include "mbk/files/hdf5/write_hdf5.h"
#include "mbk/files/recording/encode.h"
#include "mbk/files/recording/mat_variables.h"

namespace mbk::recording {
namespace {

constexpr std::size_t kUserBlock = 512;
constexpr std::string_view kReferred = "#refs#";

hdf5::Value one_number(double value, hdf5::Stored stored) {
  return {{}, hdf5::Numbers{Vector::Constant(1, value), stored}};
}

hdf5::Dataset dataset(const Matrix& values) {
  const std::vector<std::uint64_t> shape{static_cast<std::uint64_t>(values.cols()),
                                         static_cast<std::uint64_t>(values.rows())};
  return {{shape, hdf5::Numbers{values.reshaped(), hdf5::Stored::float64}},
          {{"MATLAB_class", hdf5::one_text("double")}}};
}

hdf5::Dataset dataset(const std::string& text) {
  hdf5::Attributes attributes{{"MATLAB_class", hdf5::one_text("char")},
                              {"MATLAB_int_decode", one_number(2, hdf5::Stored::int32)}};
  const std::u16string units = utf16_from_utf8(text);
  if (units.empty()) {  // its dimensions are stored instead
    attributes["MATLAB_empty"] = one_number(1, hdf5::Stored::uint8);
    return {{{2}, hdf5::Numbers{Vector::Zero(2), hdf5::Stored::uint64}}, std::move(attributes)};
  }
  Vector values(static_cast<Index>(units.size()));
  std::ranges::copy(units, values.begin());
  return {{{units.size(), 1}, hdf5::Numbers{std::move(values), hdf5::Stored::uint16}}, std::move(attributes)};
}

/// Puts variables into a group of the file; what cells hold goes to the group #refs#.
class Encoder {
 public:
  hdf5::Group root;

  void add(hdf5::Group& group, const MatVariable& variable) {
    std::visit([&](const auto& value) { add(group, variable.name, value); }, variable.value);
  }

 private:
  template <class Value>
  void add(hdf5::Group& group, const std::string& name, const Value& value) {
    group.datasets[name] = dataset(value);
  }

  void add(hdf5::Group& group, const std::string& name, const MatVariable::Cells& cells) {
    hdf5::References references;
    for (const std::string& cell : cells) {
      auto& referred = root.groups[std::string(kReferred)].datasets;
      const std::string key = fmt::format("c{}", referred.size());
      referred[key] = dataset(cell);
      references.paths.push_back(fmt::format("/{}/{}", kReferred, key));
    }
    group.datasets[name] = {{{1, cells.size()}, std::move(references)}, {{"MATLAB_class", hdf5::one_text("cell")}}};
  }

  void add(hdf5::Group& group, const std::string& name, const MatVariable::Structure& fields) {
    hdf5::Group& structure = group.groups[name];
    structure.attributes["MATLAB_class"] = hdf5::one_text("struct");
    hdf5::Texts names;
    for (const MatVariable& field : fields) {
      add(structure, field);
      names.push_back(field.name);
    }
    structure.attributes["MATLAB_fields"] = {{names.size()}, std::move(names)};
  }
};

std::string user_block() {
  std::string block = "MATLAB 7.3 MAT-file, written by mbk HDF5 schema 1.00 .";
  block.resize(kMatHeaderText, ' ');
  block.append(8, '\0');                   // no data of subsystems
  block += std::string_view("\0\2IM", 4);  // version 0x0200, least significant byte first
  block.resize(kUserBlock, '\0');
  return block;
}

}  // namespace

Result<std::string> encode_mat_hdf5(const Recording& recording) {
  const auto variables = MBK_TRY(mat_variables(recording));
  return encode_mat_hdf5(variables);
}

Result<std::string> encode_mat_hdf5(const std::vector<MatVariable>& variables) {
  Encoder encoder;
  for (const MatVariable& variable : variables) encoder.add(encoder.root, variable);
  return hdf5::serialise(encoder.root, user_block());
}

}  // namespace mbk::recording
