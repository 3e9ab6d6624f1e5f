#include "mbk/present/result/described.h"
#include "mbk/present/result/json.h"
#include "mbk/present/result/schemas.h"

namespace mbk {

using document::Fields;
using document::List;
using document::through;

void describe(Fields<Gap>& fields) {
  fields.add("after_sample", [](const Gap& gap) { return gap.sample + 1; });
  fields.add("time_s", &Gap::time, "[s]");
  fields.add("length_s", &Gap::length, "[s]");
}

void describe(Fields<NonFinite>& fields) {
  fields.add("channel", &NonFinite::channel);
  fields.add("count", &NonFinite::count);
  fields.add("first_sample", [](const NonFinite& bad) { return bad.first + 1; });
}

void describe(Fields<MissingSamples>& fields) {
  fields.type("", "Samples that were not recorded.");
  fields.add("first_sample", [](const MissingSamples& missing) { return missing.first + 1; });
  fields.add("count", &MissingSamples::count);
  fields.add("time_s", &MissingSamples::time, "[s]");
}

void describe(Fields<Updates>& fields) {
  fields.add("kind", &Updates::staleness);
  fields.add_number("share", &Updates::share, "share of the samples");
}

void describe(Fields<ChannelFacts>& fields) {
  fields.add("name", &ChannelFacts::name);
  fields.add("unit", &ChannelFacts::unit);
  fields.add("minimum", &ChannelFacts::min);
  fields.add("maximum", &ChannelFacts::max);
  fields.add("constant", &ChannelFacts::constant);
  fields.add("clipped", &ChannelFacts::clipped);
  fields.add("update_hz", &ChannelFacts::update_hz,
             "update rate of the channel [Hz]: the rate of the recording unless its values show a lower one");
  fields.add_if([](const ChannelFacts& facts) { return facts.updates.staleness != Staleness::none; }, "stale",
                &ChannelFacts::updates, "samples that are not measurements; absent if all are");
}

void describe(Fields<Event>& fields) {
  fields.add("time_s", &Event::time, "[s]");
  fields.add("name", &Event::name);
  fields.add("value", &Event::value);
}

void describe(Fields<StoredArray>& fields) {
  fields.add("name", &StoredArray::name);
  fields.add("rows", &StoredArray::rows);
  fields.add("columns", &StoredArray::columns);
  fields.add("minimum", &StoredArray::minimum);
  fields.add("maximum", &StoredArray::maximum);
  fields.add_unless_empty("unit", &StoredArray::unit);
  fields.add_number("rate_hz", &StoredArray::rate_hz, "[Hz]").only_if([](const StoredArray& array) {
    return array.rate_hz > 0;
  });
  fields.add_unless_empty("shape", &StoredArray::shape,
                          "Lengths along all dimensions if there are more than two; rows is then the first and columns "
                          "the product of the others.");
}

namespace result {
namespace {

struct Info {
  const Recording* recording;
  const Inspection* inspection;
};

void describe(Fields<Info>& fields) {
  const auto of = [](auto member) { return through(&Info::inspection, member); };
  fields.type("Info", "Output of `mbk info --json` for one recording. Samples are counted from 1.");
  fields.header("mbk.info/1");
  fields.add("inputs", through(&Info::recording, &Recording::sources));
  fields.add("samples", of(&Inspection::samples));
  fields.add("duration_s", of(&Inspection::duration), "[s]");
  fields.add("rate_hz", of(&Inspection::rate_hz), "[Hz]");
  const auto describe_interval = [of](Fields<Info>& part) {
    part.add("minimum", of(&Inspection::interval_min));
    part.add("median", of(&Inspection::interval_median));
    part.add("maximum", of(&Inspection::interval_max));
    part.add("standard_deviation", of(&Inspection::interval_standard_deviation));
  };
  fields.group("interval_s", describe_interval, "Between samples [s].");
  fields.add("gaps", of(&Inspection::gaps));
  fields.add("duplicated_times", of(&Inspection::duplicated_times));
  fields.add("backward_times", of(&Inspection::backward_times));
  fields.add("non_finite", of(&Inspection::non_finite));
  fields.add("missing", of(&Inspection::missing));
  fields.add("channels", of(&Inspection::channels));
  fields.add("events", through(&Info::recording, &Recording::events));
  fields.add("metadata", through(&Info::recording, &Recording::metadata));
  fields.add("notes", through(&Info::recording, &Recording::notes));
}

void describe(Fields<List<Info>>& fields) {
  describe_list(fields, "Infos", "mbk.infos/1", "Output of `mbk info --json` for several recordings.");
}

struct Contents {
  const FileContents* contents;
  const Error* unrecognised;
};

void describe(Fields<Contents>& fields) {
  const auto of = [](auto member) { return through(&Contents::contents, member); };
  fields.type("Contents", "Output of `mbk info --json` for a file that is not recognised as a recording.");
  fields.header("mbk.contents/1");
  fields.add("inputs", [](const Contents& from) { return std::span(&from.contents->source, 1); });
  fields.add_choice("kind", of(&FileContents::table), "table", "variables");
  fields.add("arrays", of(&FileContents::arrays));
  fields.add("notes", of(&FileContents::notes));
  const auto describe_reason = [](Fields<Contents>& part) {
    part.add("message", through(&Contents::unrecognised, &Error::message));
    part.add("try", through(&Contents::unrecognised, &Error::remedy));
  };
  fields.group("unrecognised", describe_reason, "Why it is not recognised as a recording.");
}

}  // namespace

std::string to_json(const std::vector<Recording>& recordings, const std::vector<Inspection>& inspections) {
  std::vector<Info> all;
  for (std::size_t i = 0; i < inspections.size(); ++i) all.push_back({&recordings[i], &inspections[i]});
  return document::one_or_list<Info>(all);
}

std::string to_json(const FileContents& contents, const Error& unrecognised) {
  return document::document(Contents{&contents, &unrecognised});
}

void add_info_schemas(document::Schemas& schemas) {
  schemas["info"] = document::schema_of<Info>();
  schemas["infos"] = document::schema_of<List<Info>>();
  schemas["contents"] = document::schema_of<Contents>();
}

}  // namespace result
}  // namespace mbk
