#include "scene/environment.hpp"

#include "core/angles.hpp"
#include "core/error.hpp"
#include "core/text.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace tarn::scene {

namespace {

constexpr double sun_reach_rad = 3.0 * pi / 180.0, sun_over_sky = 30.0;

double luminance(glm::dvec3 c) { return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z; }

/// The map as directions see it.
class Map {
public:
    Map(const Image& map, double turn_deg)
        : width_(map.width_px), height_(map.height_px), turn_(turn_deg * pi / 180.0),
          radiance_(map.radiance) {}

    glm::dvec3 direction(int x, int y) const {
        const double azimuth = ((x + 0.5) / width_ - 0.5) * 2.0 * pi + turn_;
        const double elevation = (0.5 - (y + 0.5) / height_) * pi;
        return {std::cos(elevation) * std::sin(azimuth), std::cos(elevation) * std::cos(azimuth),
                std::sin(elevation)};
    }
    double solid_angle(int y) const {
        const double top = (0.5 - double(y) / height_) * pi, low = top - pi / height_;
        return 2.0 * pi / width_ * (std::sin(top) - std::sin(low));
    }
    glm::vec3& at(int x, int y) {
        return radiance_[std::size_t(y) * std::size_t(width_) + std::size_t(x)];
    }
    /// Bilinear; columns go round, rows end.
    glm::dvec3 look(double azimuth, double elevation) const {
        const double turns = (azimuth - turn_) / (2.0 * pi) + 0.5;
        const double x = (turns - std::floor(turns)) * width_ - 0.5;
        const double y = std::clamp((0.5 - elevation / pi) * height_ - 0.5, 0.0, height_ - 1.0);
        const int x0 = int(std::floor(x)), y0 = int(y), y1 = std::min(y0 + 1, height_ - 1);
        const auto value = [&](int col, int row) {
            return glm::dvec3(radiance_[std::size_t(row) * std::size_t(width_) +
                                        std::size_t((col + width_) % width_)]);
        };
        const double u = x - x0, v = y - y0;
        return (1 - v) * ((1 - u) * value(x0, y0) + u * value(x0 + 1, y0)) +
               v * ((1 - u) * value(x0, y1) + u * value(x0 + 1, y1));
    }
    int width() const { return width_; }
    int sky_rows() const { return height_ / 2; }

private:
    int width_, height_;
    double turn_;
    std::vector<glm::vec3> radiance_;
};

/// Takes the sun out of the map.
void take_sun(Map& map, Lighting& out) {
    double sum = 0.0, angle = 0.0, most = 0.0;
    glm::dvec3 brightest(0, 0, 1);
    for (int y = 0; y < map.sky_rows(); ++y)
        for (int x = 0; x < map.width(); ++x) {
            const double l = luminance(map.at(x, y));
            sum += l * map.solid_angle(y);
            angle += map.solid_angle(y);
            if (l > most) {
                most = l;
                brightest = map.direction(x, y);
            }
        }
    // The mean without what may be the sun: one bright place must not hide itself in it.
    const double reach = std::cos(sun_reach_rad), around = std::cos(2.0 * sun_reach_rad);
    glm::dvec3 ring(0.0);
    double ring_angle = 0.0;
    for (int y = 0; y < map.sky_rows(); ++y)
        for (int x = 0; x < map.width(); ++x) {
            const double cosine = glm::dot(map.direction(x, y), brightest), a = map.solid_angle(y);
            if (cosine >= reach) {
                sum -= luminance(map.at(x, y)) * a;
                angle -= a;
            } else if (cosine >= around) {
                ring += a * glm::dvec3(map.at(x, y));
                ring_angle += a;
            }
        }
    const double least = sun_over_sky * std::max(sum, 0.0) / std::max(angle, 1e-9);
    if (!(most > least) || !(ring_angle > 0.0))
        return;
    ring /= ring_angle;
    glm::dvec3 towards(0.0);
    for (int y = 0; y < map.sky_rows(); ++y)
        for (int x = 0; x < map.width(); ++x) {
            const glm::dvec3 d = map.direction(x, y);
            const double l = luminance(map.at(x, y));
            if (glm::dot(d, brightest) < reach || l <= 2.0 * luminance(ring))
                continue;
            const glm::dvec3 over = glm::max(glm::dvec3(map.at(x, y)) - ring, glm::dvec3(0.0));
            out.sun_irradiance += map.solid_angle(y) * over;
            towards += map.solid_angle(y) * luminance(over) * d;
            map.at(x, y) = glm::vec3(ring);
        }
    out.sun_direction = glm::normalize(towards);
    out.sun_disc = true;
}

} // namespace

Lighting environment(const Image& image, double turn_deg) {
    if (image.width_px != 2 * image.height_px || image.height_px < 16)
        throw Error(
            text("an environment map of ", image.width_px, " x ", image.height_px, " pixels"),
            "give one in latitude and longitude: twice as wide as high, at least 32 x 16");
    for (const glm::vec3& c : image.radiance)
        for (int k = 0; k < 3; ++k)
            if (!(c[k] >= 0.0f && std::isfinite(c[k])))
                throw Error("an environment map with a value that is negative or not a number");
    Map map(image, turn_deg);
    Lighting out;
    out.sun_direction = {0, 0, 1};
    out.sun_disc = false;
    take_sun(map, out);
    out.sky.whole_turn = true;
    out.sky.azimuths = std::clamp(image.width_px, 64, 2048) + 1;
    out.sky.elevations = std::clamp(image.height_px / 2, 64, 512);
    const int finer = std::clamp(image.width_px / out.sky.azimuths + 1, 1, 8);
    for (int j = 0; j < out.sky.elevations; ++j)
        for (int i = 0; i < out.sky.azimuths; ++i) {
            glm::dvec3 sum(0.0); // over what lies nearer to this entry than to others
            for (int k = 0; k < finer * finer; ++k) {
                const double du = ((k % finer) + 0.5) / finer - 0.5,
                             dv = ((k / finer) + 0.5) / finer - 0.5;
                const double v = std::clamp((j + dv) / (out.sky.elevations - 1), 0.0, 1.0);
                sum += map.look((i + du) / (out.sky.azimuths - 1) * 2.0 * pi, 0.5 * pi * v * v);
            }
            out.sky.radiance.emplace_back(sum / double(finer * finer));
        }
    out.sky_irradiance = horizontal_irradiance(out.sky);
    return out;
}

} // namespace tarn::scene
