#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace CLI {
class App;
class Option;
} // namespace CLI

namespace relume {

/// Adds --pages: a number, or auto.
CLI::Option* addPagesOption(CLI::App& command, std::string& pages);

/// Returns how many pages --pages asks for: nothing where it is not given, 0 for as many as a density needs.
std::optional<uint32_t> askedPages(const std::string& pages);

/// Throws UsageError where so many pages (0: as the density needs) of edge `size` (0: as the density needs)
/// cannot be.
void checkPages(uint32_t pages, uint32_t size, double density);

} // namespace relume
