#pragma once
/// @file compare.hpp  How far two pictures are apart.
#include "core/image.hpp"

namespace tarn::image {

/// Figures of a picture held against a reference, linear values.
/// Relative error of a pixel: relative_error() of core/image.hpp.
struct Difference {
    double mean_relative = 0.0, p95_relative = 0.0, p99_relative = 0.0, max_relative = 0.0;
    double psnr_db = 0.0;        ///< peak = the reference's 99th percentile; infinity when equal
    std::size_t worst_pixel = 0; ///< index of the greatest relative error
    bool finite = true;          ///< false if a value of either is not finite: never a pass
};

/// @throws tarn::Error  if the sizes differ
Difference compare(const Image& got, const Image& expected);

/// First-hit distances: pixels that differ by more than max(quantum_m, share * distance); sky
/// beside no sky is different too. 1/distance is linear over the picture of a plane, however
/// grazing, so an edge is where its second difference exceeds 2 % of it.
struct DistanceDifference {
    std::size_t pixels = 0;
    std::size_t edges = 0;     ///< beside an outline or sharp crease of the reference: not judged
    std::size_t different = 0; ///< of the others
    double worst_m = 0.0;      ///< greatest difference among pixels that are no edges
};
DistanceDifference compare_distances(const Image& got, const Image& expected, double quantum_m,
                                     double share);

/// Share of pixels where a person would see a difference on a screen of 45 degrees that shows the
/// reference's 99th percentile as white of 100 cd/m2 (Yee, "A perceptual metric for production
/// testing", 2004, as OpenImageIO has it). In a file of its own: the others need no library.
double visible_share(const Image& got, const Image& expected);

} // namespace tarn::image
