// How far the contacts of a step are from the laws of contact: the certificate of WorldDef::report_residual.
//
//   residual.remember(bodies);                                      // before the step
//   report.residual = residual.measure(contacts, proxies, bodies, {gravity, dt, substeps});   // after it
#pragma once

#include <carom/dynamics/detail/contact_set.hpp>
#include <carom/dynamics/detail/proxies.hpp>
#include <carom/dynamics/detail/room.hpp>
#include <carom/dynamics/step_report.hpp>

#include <span>
#include <vector>

namespace carom::dynamics {

struct ResidualStep {
    dvec3 gravity{0.0};  ///< [m/s²]
    double dt = 0.0;     ///< [s]
    int substeps = 8;    ///< that the contacts' impulses are of one of
};

class ResidualMeter {
public:
    void remember(const BodyArrays& bodies) { before_ = bodies.states; }

    /// Pairs that fly (impacts.hpp) are left out, and so are locked axes: what holds them is no contact.
    /// @param jointed  by slot: 1 for bodies whose balance is left out, since joints hold them too; empty where there are none.
    [[nodiscard]] ContactResidual measure(const ContactSet& contacts, const ProxySet& proxies, const BodyArrays& bodies, const ResidualStep& step,
                                          std::span<const unsigned char> jointed);
    [[nodiscard]] std::size_t memory() const noexcept { return held_by(before_, loads_); }

private:
    struct Load {
        dvec3 impulse{0.0};    // of all contacts, over the whole step [N s]
        double lengths = 0.0;  // of these and of gravity's
        bool touched = false;
    };
    void add_impulse(const ContactPair& pair, const dvec3& impulse);
    [[nodiscard]] double imbalance(std::size_t slot, const BodyArrays& bodies, const ResidualStep& step) const;

    std::vector<BodyState> before_;
    std::vector<Load> loads_;  // by slot
};

}  // namespace carom::dynamics
