#include "app/bench/whole_report.h"

#include <fmt/format.h>

namespace relume {
namespace {

PhaseTime sumOf(const WholeBake& bake, const char* name, bool solver) {
    PhaseTime sum{name, 0, 0};
    for (const PhaseTime& phase : bake.phases) {
        if (!solver && phase.name == "solve") continue;
        sum.seconds += phase.seconds;
        sum.cpuSeconds += phase.cpuSeconds;
    }
    return sum;
}

} // namespace

PhaseTime wholeOf(const WholeBake& bake) {
    return sumOf(bake, "sum", true);
}

PhaseTime besideSolver(const WholeBake& bake) {
    return sumOf(bake, "all but solve", false);
}

std::string wholeTable(const WholeBake& bake) {
    std::string table = fmt::format("{0} x {0}, {1} patches, {2} triangles, {3}\n", bake.size, bake.patches,
                                    bake.triangles, bake.tracer);
    table += fmt::format("{:<14} {:>9} {:>9} {:>7}\n", "part", "s", "CPU s", "share");
    const PhaseTime whole = wholeOf(bake);
    const auto add = [&](const PhaseTime& phase) {
        table +=
            fmt::format("{:<14} {:>9.3f} {:>9.3f} {:>5.1f} %\n", phase.name, phase.seconds, phase.cpuSeconds,
                        whole.seconds > 0 ? 100.0 * phase.seconds / whole.seconds : 0.0);
    };
    for (const PhaseTime& phase : bake.phases)
        add(phase);
    add(besideSolver(bake));
    add(whole);
    return table;
}

nlohmann::ordered_json wholeJson(const WholeBake& bake) {
    nlohmann::ordered_json seconds = nlohmann::ordered_json::object(), cpu = seconds;
    std::vector<PhaseTime> rows = bake.phases;
    rows.push_back(besideSolver(bake));
    rows.push_back(wholeOf(bake));
    for (const PhaseTime& phase : rows) {
        seconds[phase.name] = phase.seconds;
        cpu[phase.name] = phase.cpuSeconds;
    }
    return {{"tracer", bake.tracer},       {"size", bake.size},  {"patches", bake.patches},
            {"triangles", bake.triangles}, {"seconds", seconds}, {"cpuSeconds", cpu}};
}

} // namespace relume
