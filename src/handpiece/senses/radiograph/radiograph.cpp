// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/radiograph/radiograph.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <iterator>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/base/core/portable_math.h"
#include "handpiece/model/case/work_on.h"
#include "handpiece/senses/radiograph/bone.h"
#include "handpiece/senses/radiograph/burned_text.h"
#include "handpiece/senses/radiograph/projection.h"

namespace handpiece::radiograph {
namespace {

/// The window: from the first share to the second of what hard tissue takes, so wide at least and at most.
constexpr double kHardFrom = 0.5;  ///< attenuation; cheek and gingiva take less
constexpr double kWindowFrom = 0.1, kWindowTo = 0.95, kNarrowest = 0.8, kWidest = 2.0;
/// Darkest that is told apart: what no quantum passes has no logarithm.
constexpr double kLeastSignal = 1e-4;

}  // namespace

Exposure expose(const cases::Case& toothCase, const Projection& projection, const Settings& settings,
                const core::Progress& progress) {
    check(settings);
    const Beam beam(settings.kv, settings.filtrationMm, settings.cheekMm, settings.filling);
    const Scene scene(toothCase);
    const Bone bone(scene, projection);
    Exposure exposure{projection.width, projection.height, {}};
    const auto width = static_cast<std::size_t>(projection.width), height = static_cast<std::size_t>(projection.height);
    std::vector<double> sum(width * height, 0.0);
    const int each = settings.focalSpotMm > 0.0 ? settings.spotPoints : 1, points = each * each;
    for (int n = 0; n < points; ++n) {
        // Points of the spot share its square evenly, rays of each pass another part of the pixel: rows of the spot
        // and columns of the pixel change places, so that the two do not move together.
        const int i = n % each, j = n / each;
        const auto share = [&](int k) { return (2 * k + 1.0) / (2 * each) - 0.5; };
        const Shadow shadow(scene, bone, projection, core::Vec2(share(i), share(j)) * settings.focalSpotMm,
                            core::Vec2(share(j), share(each - 1 - i)));
        const core::Progress part =
            core::part(progress, static_cast<double>(n) / points, static_cast<double>(n + 1) / points);
        std::atomic<std::size_t> done{0};
        core::parallelFor(height, 8, [&](std::size_t begin, std::size_t end) {
            Shadow::Work work;
            for (std::size_t y = begin; y < end; ++y) {
                double* to = &sum[y * width];
                // 1 is taken off, so that a ray through nothing adds nothing.
                shadow.row(static_cast<int>(y), work,
                           [&](int column, const Paths& paths) { to[column] += beam.transmission(paths) - 1.0; });
                core::report(part, static_cast<double>(++done) / static_cast<double>(height));
            }
        });
    }
    exposure.signal.resize(sum.size());
    for (std::size_t p = 0; p < sum.size(); ++p)
        exposure.signal[p] = static_cast<float>(1.0 + sum[p] / points);
    return exposure;
}

double greyOf(double attenuation, double windowCentre, double windowWidth) {
    const auto sigmoid = [&](double a) { return 1.0 / (1.0 + core::exp(-4.0 * (a - windowCentre) / windowWidth)); };
    const double black = sigmoid(0.0);
    return std::clamp((sigmoid(attenuation) - black) / (1.0 - black), 0.0, 1.0);
}

Picture develop(const Exposure& exposure) {
    Picture picture{exposure.width, exposure.height, {}};
    std::vector<float> attenuation(exposure.signal.size());
    core::parallelFor(attenuation.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t p = begin; p < end; ++p)
            attenuation[p] =
                static_cast<float>(-core::log(std::max(static_cast<double>(exposure.signal[p]), kLeastSignal)));
    });
    std::vector<float> hard;
    std::copy_if(attenuation.begin(), attenuation.end(), std::back_inserter(hard),
                 [](float a) { return static_cast<double>(a) > kHardFrom; });
    if (!hard.empty()) {
        const auto atShare = [&](double share) {
            const auto rank = static_cast<std::ptrdiff_t>(share * static_cast<double>(hard.size() - 1));
            std::nth_element(hard.begin(), hard.begin() + rank, hard.end());
            return static_cast<double>(hard[static_cast<std::size_t>(rank)]);
        };
        const double from = atShare(kWindowFrom), to = atShare(kWindowTo);
        picture.windowCentre = 0.5 * (from + to);
        picture.windowWidth = std::clamp(to - from, kNarrowest, kWidest);
    }
    picture.grey.resize(attenuation.size());
    core::parallelFor(attenuation.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t p = begin; p < end; ++p)
            picture.grey[p] = static_cast<std::uint16_t>(std::lround(
                65535.0 * greyOf(static_cast<double>(attenuation[p]), picture.windowCentre, picture.windowWidth)));
    });
    burn(picture, "SIMULATED");
    return picture;
}

Radiograph take(const cases::Case& toothCase, const Settings& settings, const core::Progress& progress) {
    // The patient bites on the holder's wing.
    if (settings.view == View::bitewing && !toothCase.opening.isIdentity())
        return take(cases::inOcclusion(toothCase), settings, progress);
    Radiograph r;
    r.settings = settings;
    r.fdiNumber = settings.fdiNumber != 0 ? settings.fdiNumber : toothCase.fdiNumber;
    r.projection = project(toothCase, settings);
    Exposure exposure = expose(toothCase, r.projection, settings, core::part(progress, 0.0, 0.95));
    detect(exposure, settings);
    r.picture = develop(exposure);
    core::report(progress, 1.0);
    return r;
}

}  // namespace handpiece::radiograph
