#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace relume {

// These tell what options take. They stand for the checks that come with CLI11, which let nan pass and do not
// always say what is allowed. --help shows what each allows, and so does the message about any other text:
// "--density: '-1' is not allowed: give a number above 0, at most 1000000".

/// Allows a finite number, bounds included.
CLI::Validator numberFrom(double least, double most);
/// Allows a finite number above `above`, at most `most`.
CLI::Validator numberAbove(double above, double most);

/// Allows decimal digits, which are never octal.
CLI::Validator wholeFrom(uint64_t least, uint64_t most);

/// Allows the same, and one word.
CLI::Validator wholeFromOr(uint64_t least, uint64_t most, const std::string& word);

/// Allows one of these words, which may be numbers.
CLI::Validator oneOf(std::vector<std::string> words);
/// Allows the same, in capitals too.
CLI::Validator oneOfAnyCase(std::vector<std::string> words);

/// Allows powers of two. Both bounds are powers of two themselves.
CLI::Validator powerOfTwo(uint32_t least, uint32_t most);

/// Allows a folder that is there.
CLI::Validator existingFolder();

constexpr const char* kOptionCheck = "relume"; // how CLI11 names each of these

} // namespace relume
