// bench_p3p [poses]: the P3P campaign at full length (one million poses by default).
#include <cstdio>
#include <cstdlib>

#include "p3p_campaign.hpp"

int main(int argc, char** argv) {
  const long long count = argc > 1 ? std::atoll(argv[1]) : 1000000;
  struct Case {
    const char* name;
    berth::test::P3pConditions conditions;
  };
  const Case cases[] = {{"noise-free", {0, 1, false, true}},
                        {"0.05 px", {0.05, 1, false, true}},
                        {"scaled targets, 0.05 px", {0.05, 0, false, true}},
                        {"HEC-1 distortion, 0.05 px", {0.05, 1, true, true}},
                        {"0.05 px, stopping early", {0.05, 1, false, false}}};
  for (const Case& c : cases) {
    const auto result = berth::test::run_p3p_campaign(count, 7, c.conditions);
    std::printf(
        "%-26s %lld poses, %lld failures (%.1f per 100000), worst %.4f deg %.4f %%; "
        "above a tenth of the bound %lld (%.3f %%), worst %.3f, no twin %lld\n",
        c.name, static_cast<long long>(result.poses), static_cast<long long>(result.failures),
        1e5 * static_cast<double>(result.failures) / static_cast<double>(result.poses),
        result.worst_rotation_deg, 100 * result.worst_translation_ratio,
        static_cast<long long>(result.above_tenth),
        100 * static_cast<double>(result.above_tenth) / static_cast<double>(result.poses),
        result.worst_twin_ratio, static_cast<long long>(result.twin_missing));
    for (const std::string& line : result.listed) std::printf("  %s\n", line.c_str());
  }
}
