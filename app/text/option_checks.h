#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace relume {

// These tell what options take. They stand for the checks that come with CLI11, which let nan pass and do not
// always say what is allowed. --help shows what each allows, and so does the message about any other text:
// "--density: '-1' is not allowed: give a number above 0, at most 1000000".

/// A finite number, bounds included.
CLI::Validator numberFrom(double least, double most);
/// A finite number, `above` itself excluded.
CLI::Validator numberAbove(double above, double most);

/// Decimal digits, which are never octal.
CLI::Validator wholeFrom(uint64_t least, uint64_t most);

/// One of these, which may be numbers.
CLI::Validator oneOf(std::vector<std::string> words);
/// The same in capitals, too.
CLI::Validator oneOfAnyCase(std::vector<std::string> words);

/// Both bounds are powers of two themselves.
CLI::Validator powerOfTwo(uint32_t least, uint32_t most);

/// A folder that is there.
CLI::Validator existingFolder();

constexpr const char* kOptionCheck = "relume"; // how CLI11 names each of these

} // namespace relume
