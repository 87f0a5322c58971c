// How contacts are solved.
#pragma once

namespace carom {

/// Soft: substeps of soft contacts, which sag under load. Direct: every island of bodies in contact is solved as one convex problem, to
/// WorldDef::direct_sag. Automatic: direct where soft contacts would sag by more than 1e-3 of the smallest extent, soft elsewhere. An island
/// that the direct solve cannot do in WorldDef::direct_budget, that bounces, has locked axes, or did not converge is solved softly with any of them.
/// Impulses: sequential impulses with Baumgarte's push, WorldDef::substeps passes over the contacts and no substeps: what engines did before substeps, the baseline
/// of comparisons. Islands that bounce or have locked axes are solved softly with it too.
enum class ContactMethod : unsigned char { Automatic, Soft, Direct, Impulses };

/// @return "automatic", "soft", "direct", "impulses": as the program's option spells it.
[[nodiscard]] const char* to_string(ContactMethod method) noexcept;

}  // namespace carom
