#include "mbk/present/request/stored_result.h"

#include "mbk/files/contents/read_text.h"
#include "mbk/measure/analyse/ellipses.h"
#include "mbk/measure/analyse/judge_passivity.h"

namespace mbk::request {

Result<std::vector<result::StoredResult>> stored_results(const std::filesystem::path& file) {
  const auto text = MBK_TRY(read_text(file));
  auto results = result::results_from_json(text);
  if (!results) return tl::unexpected(results.error().in(file.string()));
  return results;
}

Result<Passivity> passivity_of(const result::StoredResult& stored, const AskedBand& asked) {
  const Identification& main = stored.identification;
  Passivity passivity;
  passivity.band = stored.passivity.band;
  if (stored.passivity.energy) {
    passivity.trial = analyse::trial_passivity(main, *stored.passivity.energy, stored.passivity.lines);
  }
  if (!asked && !stored.passivity.judged) {
    if (!stored.passivity.energy) {
      return bad_usage("it does not say in which band its model can be judged", "add --band LOW:HIGH in Hz");
    }
    passivity.prediction = analyse::predict_passivity({}, main.usable, std::nullopt);
    return passivity;
  }
  const PassivityBand band =
      asked ? analyse::asked_band(asked->first, asked->second, passivity.band) : *stored.passivity.judged;
  const Identification* first = &main;
  const Identification* other = stored.alternative ? &*stored.alternative : nullptr;
  if (other != nullptr && stored.passivity.predicts == other->method) std::swap(first, other);
  auto models = MBK_TRY(analyse::model_passivities({first, other}, band));
  passivity.models = std::move(models);
  passivity.prediction = analyse::predict_passivity(passivity.models, main.usable, passivity.band);
  return passivity;
}

Result<Measurement> restored(result::StoredResult stored) {
  Measurement measured;
  if (stored.passivity.energy || stored.passivity.judged) {
    auto passivity = MBK_TRY(passivity_of(stored, {}));
    measured.passivity = std::move(passivity);
  }
  measured.identification = std::move(stored.identification);
  measured.alternative = std::move(stored.alternative);
  if (measured.identification.axes > 1 && measured.identification.model.M.allFinite()) {
    MBK_TRY(analyse::add_ellipses(measured));
  }
  return measured;
}

}  // namespace mbk::request
