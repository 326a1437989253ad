#include "core/number_table.hpp"

#include "core/error.hpp"
#include "core/text.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>

namespace tarn {

std::vector<NumberRow> read_number_table(const std::filesystem::path& path, std::size_t least,
                                         std::size_t most, const std::string& hint) {
    std::ifstream in(path);
    if (!in || !std::filesystem::is_regular_file(path))
        throw Error(path.string() + ": cannot be read", "check the path");
    std::vector<NumberRow> rows;
    std::string line;
    for (int number = 1; std::getline(in, line); ++number) {
        if (number > 100'000)
            throw Error(path.string() + ": has more than 100000 lines", hint);
        if (number == 1 && line.starts_with("\xef\xbb\xbf")) // spreadsheets' mark of UTF-8
            line.erase(0, 3);
        line = line.substr(0, line.find('#'));
        std::replace_if(
            line.begin(), line.end(),
            [](char c) { return c == ',' || c == ';' || c == '\t' || c == '\r'; }, ' ');
        std::istringstream words(line);
        NumberRow row{number, {}};
        std::size_t count = 0;
        bool numbers = true, first_is_number = false;
        for (std::string word; words >> word; ++count) {
            char* end = nullptr;
            const double value = std::strtod(word.c_str(), &end);
            const bool good = *end == '\0' && std::isfinite(value);
            first_is_number = first_is_number || (count == 0 && end != word.c_str());
            numbers = numbers && good;
            if (row.values.size() <= most)
                row.values.push_back(value);
        }
        if (count == 0 || (rows.empty() && !first_is_number))
            continue;
        if (!numbers || count < least || count > most)
            throw Error(text(path.string(), ", line ", number, ": is not ", least,
                             least == most ? "" : text(" to ", most), " numbers"),
                        hint);
        rows.push_back(std::move(row));
    }
    return rows;
}

} // namespace tarn
