#pragma once
/// @file number_table.hpp  Text files of numbers, as people and spreadsheets write them.
#include <filesystem>
#include <string>
#include <vector>

namespace tarn {

struct NumberRow {
    int line = 0; ///< in the file, from 1
    std::vector<double> values;
};

/// Rows of finite numbers separated by commas, semicolons or blanks. Passed over: what follows a
/// `#`, empty lines, and headings: lines that begin with no number and come before the first row.
///
/// @param least, most  numbers a row
/// @param hint         what to write, for errors
/// @throws tarn::Error  naming file and line, if the file cannot be read, a row is not of that many
///                      numbers, or there are more than 100000 lines
std::vector<NumberRow> read_number_table(const std::filesystem::path& path, std::size_t least,
                                         std::size_t most, const std::string& hint);

} // namespace tarn
