#include "mbk/thesis/reproduce.h"

#include <fmt/format.h>

#include <algorithm>

#include "mbk/thesis/exhibits.h"

namespace mbk::thesis {
namespace {

std::vector<Maker> all_makers() {
  std::vector<Maker> all;
  for (const auto part :
       {relaxed_tables(), relaxed_figures(), rigid_tables(), rigid_figures(), reconstructed_tables(), rig_exhibits(),
        virtual_sensor_exhibits(), apparatus_exhibits(), statements(), slips(), questions(), future_work()}) {
    all.insert(all.end(), part.begin(), part.end());
  }
  return all;
}

Result<std::vector<Maker>> chosen(const std::vector<std::string>& only) {
  std::vector<Maker> makers = all_makers();
  for (const std::string& id : only) {
    if (std::ranges::find(makers, id, &Maker::id) == makers.end()) {
      return bad_usage(fmt::format("'{}' is not among what is made again", id),
                       "'mbk reproduce --list' names everything");
    }
  }
  if (!only.empty()) {
    std::erase_if(makers, [&](const Maker& maker) { return std::ranges::find(only, maker.id) == only.end(); });
  }
  return makers;
}

}  // namespace

std::vector<ExhibitName> exhibit_names() {
  std::vector<ExhibitName> names;
  for (const Maker& maker : all_makers()) names.push_back({maker.id, maker.title});
  return names;
}

Result<Reproduction> reproduce(const Source& source, const ReproduceOptions& options) {
  const auto makers = chosen(options.only);
  if (!makers) return tl::unexpected(makers.error());
  Workbench bench(source.given, {options.seed, options.threads});
  Reproduction reproduction;
  reproduction.source = source.name;
  for (const Maker& maker : *makers) {
    if (options.progress) {
      options.progress(static_cast<int>(reproduction.exhibits.size()), static_cast<int>(makers->size()), maker.id);
    }
    Exhibit exhibit;
    exhibit.id = maker.id;
    exhibit.title = maker.title;
    exhibit.kind = maker.kind;
    exhibit.chapter = maker.chapter;
    exhibit.provenance = maker.provenance;
    if (auto ok = maker.make(bench, exhibit); !ok) return tl::unexpected(ok.error().in(maker.id));
    exhibit.commands.insert(exhibit.commands.begin(), fmt::format("mbk reproduce --only {} --out folder", maker.id));
    compare(source, exhibit);
    reproduction.exhibits.push_back(std::move(exhibit));
  }
  return reproduction;
}

}  // namespace mbk::thesis
