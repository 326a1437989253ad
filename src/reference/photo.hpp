#pragma once
/// @file photo.hpp  The orthophoto as a linear-light mip chain, looked up in double precision.
#include "core/image.hpp"

#include <glm/vec4.hpp>
#include <vector>

namespace tarn::reference {

class Photo {
public:
    Photo() = default;
    explicit Photo(const Ortho& ortho);
    bool empty() const { return levels_.empty(); }
    /// @param x, y         scene metres
    /// @param footprint_m  size of the pixel on the ground
    /// @return  linear colour and alpha; alpha 0 outside
    glm::dvec4 at(double x, double y, double footprint_m) const;

private:
    struct Level {
        int width, height;
        std::vector<glm::dvec4> texels;
        glm::dvec4 bilinear(double u, double v) const;
    };
    std::vector<Level> levels_;
    double west_m_ = 0.0, north_m_ = 0.0, spacing_m_ = 1.0, width_m_ = 0.0, height_m_ = 0.0;
};

} // namespace tarn::reference
