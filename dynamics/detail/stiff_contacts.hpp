// Which contacts the soft solver would let sink too far: the law of their sag, before anything is solved.
//
//   if (stiff.look(contacts, proxies, bodies, law, keep)) ...   // some manifold m has stiff.marks()[m] != 0
#pragma once

#include <carom/core/radix_sort.hpp>
#include <carom/dynamics/detail/contact_set.hpp>
#include <carom/dynamics/detail/proxies.hpp>
#include <carom/dynamics/detail/room.hpp>
#include <carom/dynamics/detail/scratch_pool.hpp>

#include <cstddef>
#include <cstdint>
#include <span>

namespace carom::dynamics {

/// A soft contact at rest is a spring: it sags by s = F (1/m_a + 1/m_b) / w², w = 2 pi contact_rate / substep, twice that against what
/// cannot move.
struct SagLaw {
    dvec3 gravity{0.0};
    double dt = 0.0;            ///< of the step [s]
    double substep = 0.0;       ///< [s]
    double contact_rate = 0.0;  ///< WorldDef::contact_rate
    double share = 0.0;         ///< of the smaller shape's smallest extent: what sags by more is stiff

    /// @param load  the normal force of the manifold [N]. @return the sag over what it may be; above 1 it is stiff.
    [[nodiscard]] double excess(const ContactPair& pair, const ProxySet& proxies, const BodyArrays& bodies, double load) const noexcept;
};

/// Loads and stiff contacts of a step.
///
/// The load of a manifold is its normal force in the step before. In a step in which contacts came it is at least the weight that rests on it: what
/// a body weighs and bears goes in equal parts to the manifolds under it, from the highest body down. So a heavy body on a light one
/// is found before it has pressed on it for a single step.
class StiffContacts {
public:
    /// @param pool  for what is needed from look() to release().
    explicit StiffContacts(ScratchPool& pool) noexcept : memory_(pool) {}

    /// A manifold of a body with keep[slot] != 0 is stiff from half the excess on, so that islands do not go to and fro.
    /// @return whether any is. Cost: some 3 ns a manifold; where contacts came, a sort of the bodies besides.
    bool look(const ContactSet& contacts, const ProxySet& proxies, const BodyArrays& bodies, const SagLaw& law, std::span<const unsigned char> keep);

    [[nodiscard]] std::span<const unsigned char> marks() const noexcept { return marks_; }
    /// [N] a manifold.
    [[nodiscard]] std::span<const double> loads() const noexcept { return loads_; }
    /// Gives marks and loads back to the pool.
    void release() noexcept { loads_ = {}, marks_ = {}, memory_.release(); }
    [[nodiscard]] std::size_t memory() const noexcept { return held_by(scratch_.keys, scratch_.payload); }

private:
    void add_up_weights(const ContactSet& contacts, const BodyArrays& bodies, const SagLaw& law, std::byte* room);

    ScratchList<std::byte> memory_;
    std::span<double> loads_;           // by manifold, as are these
    std::span<unsigned char> marks_;
    std::size_t manifolds_before_ = 0;
    RadixScratch scratch_;
};

}  // namespace carom::dynamics
