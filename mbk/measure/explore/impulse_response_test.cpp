#include "mbk/measure/explore/impulse_response.h"
#include "mbk/measure/explore/parallel_cascade.h"

#include <gtest/gtest.h>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>


namespace mbk::explore {
namespace impulse_response_test {

TEST(Prototype, Ankle) {
  for (const char* name : {"z_df", "z_df2", "z_pf"}) {
    std::ifstream in(std::string(std::getenv("MBK_DATA_DIR")) + "/ankle/" + name + ".csv");
    std::string line;
    std::getline(in, line);
    std::vector<double> p, f;
    double t = 0, a = 0, b = 0;
    while (std::getline(in, line)) {
      if (std::sscanf(line.c_str(), "%lf,%lf,%lf", &t, &a, &b) == 3) {
        p.push_back(a);
        f.push_back(-b);
      }
    }
    ExplorationTrial trial;
    trial.axes = 1;
    trial.sample_time = 0.001;
    trial.input = Eigen::Map<Vector>(p.data(), Index(p.size()));
    trial.output = Eigen::Map<Vector>(f.data(), Index(f.size()));
    trial.split = 40000;
    const auto signals = limb_signals(std::span(&trial, 1));
    ASSERT_TRUE(signals) << signals.error().line();
    for (int k = 0; k < 2; ++k) {
      const auto r = impulse_response(*signals, k ? ImpulseResponseOptions{.memory_s = 0.04} : ImpulseResponseOptions{});
      ASSERT_TRUE(r) << r.error().line();
      std::printf("%s memory %g rank %ld of %ld VAF %.2f ± %.2f MBK %.2f  M %g ± %g B %g ± %g K %g ± %g F %g p %g\n", name,
                  r->memory, r->rank, r->directions, r->explained[0].vaf, r->explained[0].vaf_half_width,
                  r->explained_by_model[0].vaf, r->model.M(0, 0), r->model.M_half_width(0, 0), r->model.B(0, 0),
                  r->model.B_half_width(0, 0), r->model.K(0, 0), r->model.K_half_width(0, 0), r->model.statistic,
                  r->model.p_value);
    }
    const auto c = parallel_cascade(*signals);
    ASSERT_TRUE(c) << c.error().line();
    std::printf("  %s\n", c->why.c_str());
    for (const auto& k : c->candidates) std::printf("  dir %g vaf %.2f se %.2f\n", k.direction.size() ? k.direction[0] : 0.0, k.vaf, k.vaf_error);
    if (c->found == DelayedResponse::reflex)
      std::printf("  delay %g (%g %g) memory %g rank %ld gain %g ± %g order %ld alone %.2f both %.2f ± %.2f I %.2f R %.2f ± %.2f\n", c->delay, c->delay_low,
                  c->delay_high, c->memory, c->reflex_rank, c->gain[0], c->gain_half_width[0], c->nonlinearity.size(), c->shares[0].intrinsic_alone.vaf, c->shares[0].both.vaf,
                  c->shares[0].both.vaf_half_width, c->shares[0].intrinsic_path.vaf, c->shares[0].reflex_path.vaf,
                  c->shares[0].reflex_path.vaf_half_width);
  }
}

}  // namespace impulse_response_test
}  // namespace mbk::explore
