#include "thesis/reproduce.h"

#include <fmt/format.h>

#include <algorithm>

#include "mbk/simulate/laboratory/scenario.h"
#include "thesis/exhibits.h"

namespace mbk::thesis {
namespace {

std::vector<Maker> all_makers() {
  std::vector<Maker> all;
  for (const auto part : {relaxed_tables(), signal_figures(), relaxed_figures(), rigid_tables(), rigid_figures(),
                          reconstructed_tables(), rig_exhibits(), virtual_sensor_exhibits(), apparatus_exhibits(),
                          statements(), errata(), questions(), future_work()}) {
    all.insert(all.end(), part.begin(), part.end());
  }
  return all;
}

Result<std::vector<Maker>> chosen(const std::vector<std::string>& only) {
  std::vector<Maker> makers = all_makers();
  for (const std::string& id : only) {
    if (std::ranges::find(makers, id, &Maker::id) == makers.end()) {
      return bad_usage(fmt::format("there is no exhibit '{}'", id), "'mbk reproduce --list' lists all exhibits");
    }
  }
  if (!only.empty()) {
    std::erase_if(makers, [&](const Maker& maker) { return std::ranges::find(only, maker.id) == only.end(); });
  }
  return makers;
}

/// Read once.
const Result<std::vector<ExhibitText>>& texts() {
  static const Result<std::vector<ExhibitText>> kAll = read_text(text_files());
  return kAll;
}

/// nullptr where it has none.
const ExhibitText* text_of(std::string_view id) {
  if (!texts()) return nullptr;
  const auto found = std::ranges::find(*texts(), id, &ExhibitText::id);
  return found == texts()->end() ? nullptr : &*found;
}

}  // namespace

std::vector<ExhibitName> exhibit_names() {
  std::vector<ExhibitName> names;
  for (const Maker& maker : all_makers()) {
    const ExhibitText* text = text_of(maker.id);
    names.push_back({maker.id, text == nullptr ? "" : std::string_view(text->title)});
  }
  return names;
}

Result<Reproduction> reproduce(const Source& source, const ReproduceOptions& options) {
  const auto makers = MBK_TRY(chosen(options.only));
  if (!texts()) return tl::unexpected(texts().error());
  const TextValues common = {{"tuned_gains", laboratory::kTunedGains}};
  Workbench bench(source.given, {options.seed, options.threads});
  Reproduction reproduction;
  reproduction.source = source.name;
  for (const Maker& maker : makers) {
    if (options.progress) {
      options.progress(static_cast<int>(reproduction.exhibits.size()), static_cast<int>(makers.size()), maker.id);
    }
    const ExhibitText* text = text_of(maker.id);
    if (text == nullptr) return bad_data("there is no text of it", "", maker.id);
    Draft exhibit;
    exhibit.id = maker.id;
    exhibit.kind = maker.kind;
    exhibit.chapter = maker.chapter;
    exhibit.provenance = maker.provenance;
    if (auto ok = maker.make(bench, exhibit); !ok) return tl::unexpected(ok.error().in(maker.id));
    if (auto ok = put_text(*text, common, exhibit); !ok) return tl::unexpected(ok.error().in(maker.id));
    exhibit.commands.insert(exhibit.commands.begin(), fmt::format("mbk reproduce --only {} --out folder", maker.id));
    compare(source, exhibit);
    reproduction.exhibits.push_back(std::move(exhibit));
  }
  return reproduction;
}

}  // namespace mbk::thesis
