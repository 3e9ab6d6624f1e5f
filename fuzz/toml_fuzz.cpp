#include <cmath>

#include "fuzz/fuzz.h"
#include "mbk/base/config/document.h"
#include "mbk/simulate/laboratory/scenario.h"

namespace mbk::fuzz {
namespace {

/// Reads a few keys of every type, present or not.
void read_everything(const config::Document& document) {
  const config::Section root = document.root();
  const double number = root.number("duration_s", 1.0, config::above(0.0));
  require(std::isfinite(number), "a number is finite");
  (void)root.integer("seed", 1, 0, 1000);
  (void)root.text("condition", "");
  (void)root.flag("on", false);
  (void)root.numbers("list_mm", {1.0}, config::between(0.0, 1.0));
  (void)root.section("perturbation").vector2("direction", Eigen::Vector2d::Zero());
  (void)root.section("participant").matrix2("stiffness", Eigen::Matrix2d::Identity());
  for (const config::Section& section : root.sections("link")) (void)section.choice("kind", {{"a", 1}, {"b", 2}}, 1);
  if (auto ok = document.finish(); !ok) require_error(ok.error());
}

}  // namespace

std::vector<std::string> seeds() {
  std::vector<std::string> texts = {
      "duration_s = 2.5\nseed = 7\ncondition = \"at rest\"\non = true\nlist_mm = [1, 2.0]\n"
      "[perturbation]\ndirection = [1, 0]\n[participant]\nstiffness = [[1, 2], [3, 4]]\n[[link]]\nkind = \"a\"\n",
      "a.b.c = 1\nd = { e = 'f', g = [1e3, 0x10, -inf] }\nh = 2024-01-01T00:00:00Z\n"};
  for (const auto& scenario : laboratory::ready_scenarios()) texts.emplace_back(scenario.text);
  return texts;
}

}  // namespace mbk::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto text = mbk::fuzz::text_of(data, size);
  const auto document = mbk::config::Document::parse(text, "file.toml");
  if (!document) {
    mbk::fuzz::require_error(document.error());
  } else {
    if (const auto trials = document->trials(); !trials) mbk::fuzz::require_error(trials.error());
    mbk::fuzz::read_everything(*document);
  }
  const auto scenarios = mbk::laboratory::read_scenarios(text, "file.toml");
  if (!scenarios) {
    mbk::fuzz::require_error(scenarios.error());
  } else {
    mbk::fuzz::require(!scenarios->empty(), "a file describes at least one trial");
  }
  return 0;
}
