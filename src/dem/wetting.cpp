#include "dem/wetting.hpp"

#include "dem/fill.hpp"

#include <algorithm>
#include <cmath>
#include <queue>

namespace tarn::dem {

namespace {

struct Step {
    float height;
    Node at;
    bool operator<(const Step& other) const { return height > other.height; } // lowest first
};

/// A queue from which the lowest leaves first, for floods: what comes in is never lower than what
/// left last.
class RisingQueue {
public:
    RisingQueue(float lowest, float highest)
        : lowest_(lowest),
          per_m_(highest > lowest ? float(buckets - 1) / (highest - lowest) : 0.0f),
          waiting_(buckets) {}

    void push(const Step& step) {
        const auto bucket =
            std::size_t(std::clamp((step.height - lowest_) * per_m_, 0.0f, float(buckets - 1)));
        if (bucket <= current_)
            front_.push(step);
        else
            waiting_[bucket].push_back(step);
    }
    bool empty() {
        while (front_.empty() && current_ + 1 < buckets) {
            front_ = std::priority_queue<Step>(std::less<Step>(), std::move(waiting_[++current_]));
            waiting_[current_] = {};
        }
        return front_.empty();
    }
    /// Not when it is empty().
    Step pop() {
        const Step step = front_.top();
        front_.pop();
        return step;
    }

private:
    static constexpr std::size_t buckets = 1 << 16;
    float lowest_, per_m_;
    std::size_t current_ = 0;
    std::priority_queue<Step> front_;
    std::vector<std::vector<Step>> waiting_;
};

} // namespace

void add_footprint(const Heightfield& ground, const Heightfield& water, const LakeRecord& lake,
                   int id, LakeOf& out) {
    const std::uint16_t code = water.codes[lake.seed];
    const auto mark = static_cast<std::uint16_t>(id);
    const auto wet = [&](Node n) {
        return water.codes[n] == code && ground.elevation_m(n) < water.elevation_m(n);
    };
    std::vector<Node> seeds = lake.parts;
    seeds.push_back(lake.seed);
    for (const Node seed : seeds)
        out[seed] = mark;
    search<8>(
        ground.size(), seeds,
        [&](Node n) {
            if (out[n] == mark || !wet(n))
                return false;
            out[n] = mark;
            return true;
        },
        [](Node) {});
}

Grid<float> wetting_heights(const Grid<float>& z, const LakeOf& lake, int id, double level_m,
                            double up_to_m, int neighbours) {
    Grid<float> out(z.size, never_wet);
    const auto level = static_cast<float>(level_m);
    const auto own = [&](Node n) { return int(lake[n]) == id; };
    const auto joined = [&](Node a, Node b) {
        return neighbours == 8 || a.col == b.col || a.row == b.row;
    };
    float highest = level;
    for (const float h : z.values)
        if (h > highest) // false for NaN
            highest = h;
    RisingQueue rim(level, std::min(highest, std::max(level, static_cast<float>(up_to_m))));
    for (int row = 0; row < z.size.rows; ++row)
        for (int col = 0; col < z.size.cols; ++col) {
            const Node at{col, row};
            if (!own(at))
                continue;
            // What the scene shows as wet is wet at its level, even where the bed just reaches it.
            out[at] = std::min(z[at], highest_wet(level_m, false));
            each_neighbour(z.size, at, [&](Node n) {
                // Lower ground beside the lake that the import kept dry lies behind a dam that
                // the grid does not show: no way leads there directly.
                if (joined(at, n) && !own(n) && out[n] == never_wet && z[n] >= level) {
                    out[n] = z[n];
                    rim.push({z[n], n});
                }
            });
        }
    while (!rim.empty()) {
        const Step step = rim.pop();
        if (double(step.height) > up_to_m)
            break;
        each_neighbour(z.size, step.at, [&](Node n) {
            if (!joined(step.at, n) || own(n) || out[n] != never_wet || std::isnan(z[n]))
                return;
            out[n] = std::max(step.height, z[n]);
            rim.push({out[n], n});
        });
    }
    return out;
}

} // namespace tarn::dem
