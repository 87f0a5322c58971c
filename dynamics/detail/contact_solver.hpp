// TGS-soft: substeps of soft constraints with a relax pass, wide over coloured bundles.
//
// Source: Macklin et al., Small Steps in Physics Simulation (2019); Catto, Solver2D (2024). Departures: bundles of sixteen
// manifolds in 3-D; friction in a true circle with the scalar step 1/lambda_max; deltas of position and orientation are
// floats relative to the double pose at the start of the step.
#pragma once

#include <carom/core/executor.hpp>
#include <carom/dynamics/detail/body_kernels.hpp>
#include <carom/dynamics/detail/body_parts.hpp>
#include <carom/dynamics/detail/body_state.hpp>
#include <carom/dynamics/detail/coloring.hpp>
#include <carom/dynamics/detail/contact_bundle.hpp>
#include <carom/dynamics/detail/contact_kernels.hpp>
#include <carom/dynamics/detail/contact_prepare.hpp>
#include <carom/dynamics/detail/contact_patch.hpp>
#include <carom/dynamics/detail/part_surface.hpp>
#include <carom/dynamics/detail/phase_loop.hpp>
#include <carom/dynamics/detail/proxies.hpp>
#include <carom/dynamics/detail/rolling_rows.hpp>
#include <carom/dynamics/detail/round_rows.hpp>
#include <carom/dynamics/detail/row_rules.hpp>
#include <carom/dynamics/detail/slender.hpp>
#include <carom/dynamics/detail/turning_rows.hpp>
#include <carom/dynamics/stage.hpp>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace carom::dynamics {

struct SolverSettings {
    dvec3 gravity{0.0};          ///< [m/s²]
    double dt = 0.0;             ///< of the step [s]
    int substeps = 8;
    double contact_rate = 0.1875;  ///< frequency of soft contacts over the substep rate
    double damping = 1.0;
    double max_push = 0.1;         ///< share of the smallest extent a step
    bool resists = false;          ///< some shape resists to rolling or spinning
    [[nodiscard]] double substep() const noexcept { return dt / substeps; }
    friend bool operator==(const SolverSettings&, const SolverSettings&) = default;
};

class ContactSolver {
public:
    /// @param pool  for what is needed from prepare() or resume() to store().
    explicit ContactSolver(ScratchPool& pool) noexcept : rows_(pool), moves_(pool) {}

    /// Takes in the contacts and the bodies they touch, colours the manifolds and fills the bundles.
    /// @param held  by slot: 1 for bodies that others have moved in this step, whose contacts are left out; empty where there are none.
    void prepare(const ContactSet& contacts, std::span<const unsigned char> held, const ProxySet& proxies, const BodyArrays& bodies,
                 const SolverSettings& settings, Executor& executor);

    /// The same where contacts were patched since the last prepare() or resume(), and carry_gaps() was called: only what changed is prepared, into the lanes
    /// that are free. Lever arms and masses of the rest stay as they were. @return false where that cannot be, and nothing is ready: a body found its
    /// first contact or lost its last one, a colour has no lane left, or the settings are others.
    [[nodiscard]] bool resume(const ContactSet& contacts, const ContactChanges& changes, std::span<const unsigned char> held, const ProxySet& proxies,
                              const BodyArrays& bodies, const SolverSettings& settings, Executor& executor);

    /// Slots of dynamic bodies that prepare() takes in whether they have contacts or not: others work on their rows too. resume() needs those of the step before.
    void share(std::span<const std::uint32_t> slots);
    /// The row of a body that holds(), between passes.
    [[nodiscard]] SolverBody& body(std::uint32_t slot) noexcept { return rows_.bodies[static_cast<std::size_t>(row_of_slot_[slot])]; }
    [[nodiscard]] const SolverBody& body(std::uint32_t slot) const noexcept { return rows_.bodies[static_cast<std::size_t>(row_of_slot_[slot])]; }

    /// What is to be done, in order; run_listed() does it, in one parallel region. The kick of the substep; from the second on it brings the contacts'
    /// impulses too.
    void list_velocities(WarmStart warm_start);
    /// Of the first substep.
    void list_warm_start();
    /// @param backward  from the last colour to the first.
    void list_pass(bool bias, bool backward);
    void list_positions();
    /// @param milliseconds  by Stage; what each takes is added.
    void run_listed(Executor& executor, std::span<double> milliseconds);

    /// Gives the contacts of the last step the separations that it left them with. It must have had a Relax pass.
    void carry_gaps(ContactSet& contacts, Executor& executor);

    /// Writes the bodies' new states and the contacts' impulses back. There are no rows after that.
    void store(BodyArrays& bodies, ContactSet& contacts, Executor& executor);

    /// After a step that was not finished: resume() has to wait for the next prepare().
    void forget() noexcept { is_whole_ = false, rows_.release(), moves_.release(); }
    /// After store(). Where bundles are seldom laid out, gives back what that takes, and what they do not fill.
    void trim();
    /// [bytes], without what is of the pool.
    [[nodiscard]] std::size_t memory() const noexcept;

    /// @return whether any contact holds the body in `slot` in this step: it is the solver's, not the free integrator's.
    [[nodiscard]] bool holds(std::uint32_t slot) const noexcept { return slot < row_of_slot_.size() && row_of_slot_[slot] != kNoRow; }
    [[nodiscard]] std::size_t overflow_count() const noexcept { return coloring_.overflow_count(); }
    [[nodiscard]] std::size_t deep_count() const noexcept { return deep_count_; }
    /// @return how many relax passes a substep needs. One leaves some of the push between bodies that many others hold, and what is left is energy: a heap in
    /// which one point in 32 is deep, and more than 16 are, gets eight.
    [[nodiscard]] int relaxations() const noexcept { return deep_count_ > 16 && 32 * deep_count_ > point_count_ ? 8 : 1; }

private:
    static constexpr std::int32_t kNoRow = -1;
    static constexpr std::int32_t kKinds = kMaxManifoldPoints + 1;  // of manifolds of a part

    /// What a manifold's row needs of a shape: one cache line.
    struct alignas(64) Side {
        dvec3 origin{0.0};  ///< of the shape in the world
        dvec3 centre{0.0};  ///< of mass of its body
        float push = 0.0f;  ///< overlap of its contacts is removed at this speed at most [m/s]
        std::int32_t row = 0;
        float friction = 0.0f;
        std::optional<CombineRule> friction_rule;
        bool is_static : 1 = false, is_ball : 1 = false, is_compound : 1 = false;
    };
    static_assert(sizeof(Side) == 64);
    /// Of a bundle, in lane_order_.
    struct Lanes {
        std::uint32_t begin = 0, end = 0;
    };
    /// Of a lane of a bundle: bundle × kLanesPerBundle + lane.
    using Place = std::uint32_t;
    static constexpr Place kNowhere = ~std::uint32_t{0};
    struct Move {
        std::uint32_t manifold = 0;  ///< kUnusedLane: the lane becomes free
        Place place = 0;
        std::int32_t deep = 0;  ///< how many more points are deep
    };
    /// Where manifolds lie and which lanes are free, for resume().
    void note_places();
    [[nodiscard]] bool take_lane(std::uint32_t manifold);
    void free_lane(std::uint32_t manifold);
    [[nodiscard]] std::size_t best_lane(std::uint32_t color, std::int32_t points) const;
    void move_up(std::uint32_t manifold);
    void fill_moves(const ContactSet& contacts, const ProxySet& proxies, const BodyArrays& bodies, Executor& executor);
    void fill_group(std::size_t first, std::size_t count, const ContactSet& contacts, const ProxySet& proxies, const BodyArrays& bodies);
    void order_moves();
    void make_room(ContactBundle& bundle, std::int32_t points);
    [[nodiscard]] bool goes_on(std::span<const unsigned char> held, const SolverSettings& settings) const;
    void fill_changed_rows(const ContactSet& contacts, const ContactChanges& changes, Executor& executor);
    [[nodiscard]] Side side_of(std::uint32_t slot, const ProxySet& proxies, const BodyArrays& bodies) const;
    void mark_rows(const ContactSet& contacts, std::span<const unsigned char> held, const BodyArrays& bodies);
    void number_rows(const ContactSet& contacts, const BodyArrays& bodies);
    void begin_rows(const ProxySet& proxies, const BodyArrays& bodies, Executor& executor);
    void fill_rows(const BodyArrays& bodies, Executor& executor);
    void fill_sides(const ProxySet& proxies, const BodyArrays& bodies, Executor& executor);
    void fill_contact_rows(const ContactSet& contacts, Executor& executor);
    [[nodiscard]] ContactRows rows_of(const ContactPair& pair) const;
    [[nodiscard]] std::int32_t row_or_unmoved(std::uint32_t body) const noexcept {
        return row_of_slot_[body] == kNoRow ? static_cast<std::int32_t>(slot_of_row_.size()) : row_of_slot_[body];
    }
    [[nodiscard]] float friction_of(const Side& side, std::uint32_t proxy, std::uint16_t part, const ProxySet& proxies) const;
    [[nodiscard]] ManifoldRow row_of(const ContactSet& contacts, std::uint32_t number, const Side& a, const Side& b, const ProxySet& proxies) const;
    /// Within a colour the order is free: manifolds of as many points share bundles, so that few lanes idle, and those of like bodies lie in
    /// one part of it, so that a thread finds most of its bodies where it left them.
    void sort_by_points();
    [[nodiscard]] std::uint8_t kind_of(ContactRows rows, std::uint32_t points) const;
    [[nodiscard]] std::int32_t points_of(std::uint32_t manifold) const noexcept { return kinds_[manifold] % kKinds; }
    void lay_out_bundles();
    /// Gives each bundle as many points as one of its lanes has.
    void deal_out_points();
    void fill_lanes(Executor& executor);
    /// Of all manifolds that have a lane.
    void put_rows(const ContactSet& contacts, const ProxySet& proxies, Executor& executor);
    [[nodiscard]] ManifoldRow unused_row() const noexcept;
    /// Calls `work` for all bundles, some at a time, from several threads.
    void for_bundles(Executor& executor, FunctionRef<void(std::span<ContactBundle> some)> work);
    enum class Work : unsigned char { Kick, Damp, Precess, Show, WarmStart, WarmStartOverflow, WarmStartRows, Solve, SolveOverflow, SolveRows, Advance, Swing, Hide };
    struct Task {
        Work work = Work::Kick;
        WarmStart warm_start = WarmStart::First;
        std::uint32_t first_bundle = 0;
        std::uint32_t first_color = 0, end_color = 0;  ///< where these differ, colours of few bundles, one after the other
        SolveSettings settings{};
        int substep = 0;  ///< how often bodies have moved, this task included
        bool backward = false;
    };
    void list(std::size_t count, Stage stage, const Task& task, const std::uint32_t* starts = nullptr);
    /// The colours one after the other and the bundles that have to be alone, or these first and the colours from the back; then what is no contact.
    void list_contacts(Stage stage, const Task& task);
    [[nodiscard]] bool renews(const Task& task) const noexcept;
    void solve(std::span<ContactBundle> some, const Task& task);
    void run_task(const Task& task, std::size_t begin, std::size_t end);

    SolverSettings settings_;
    int moves_listed_ = 0;     // of the step
    bool gaps_known_ = false;  ///< of the points in the bundles: no body has moved since
    SoftContacts soft_;
    SolverBodies rows_;
    RowRules rules_;
    RollingRows rolling_;
    SlenderRows slender_;
    TurningRows turning_;
    RoundRows round_;
    std::vector<unsigned char> is_left_out_;   // by row: of round_
    std::vector<unsigned char> is_slender_;    // by row
    std::vector<std::uint32_t> slot_of_row_;
    std::vector<std::int32_t> row_of_slot_;
    std::vector<std::uint32_t> shared_;
    BodyParts parts_;
    std::size_t part_count_ = 1;
    std::array<std::uint32_t, BodyParts::kMostParts + 1> part_rows_{}, all_parts_{};  // first row of each part, and the end: without kinematic bodies and with them
    std::vector<std::uint32_t> color_parts_;    // of each colour, the first bundle of each part, counted from its own first, and the end
    std::span<Side> sides_;                    // by slot of shapes, of prepare() until the rows are filled, where these come to be
    std::vector<ContactRows> contact_rows_;    // per manifold
    std::vector<std::uint8_t> kinds_;          // per manifold: its part and number of points
    Coloring coloring_;
    std::vector<std::uint32_t> places_;        // scratch of sort_by_points()
    std::vector<std::uint32_t> lane_order_;    // of manifolds: by colour, then by part and rising number of points, so that lanes are free for those that get more
    std::vector<Color> colors_;
    std::vector<Lanes> lanes_;                 // of each bundle
    std::vector<ContactBundle> bundles_;
    std::vector<PointLanes> points_;           // of the bundles, in their order
    using MorePoints = std::array<PointLanes, kMaxManifoldPoints>;
    std::vector<std::unique_ptr<MorePoints>> more_points_;  // room for bundles that get more than they were laid out with
    std::size_t room_made_ = 0, most_room_ = 0;             // how much of that is taken, and may be
    std::uint32_t first_overflow_bundle_ = 0;  // these are solved one after the other
    std::size_t deep_count_ = 0;
    std::size_t point_count_ = 0;
    Uses layouts_;
    bool is_whole_ = false;                                    // what is in the bundles is all that the bodies of the rows have
    bool places_known_ = false;                                // those below are of what is in the bundles
    std::vector<Place> places_of_;                             // by manifold; kNowhere where it has no lane
    std::vector<std::vector<Place>> free_;                     // by colour
    std::vector<std::uint8_t> color_of_bundle_;
    std::vector<std::uint32_t> contacts_of_row_;               // of rows that move
    ScratchList<Move> moves_;                                  // of resume()
    std::size_t grown_ = 0;                                    // lanes that got more points since they were laid out
    std::vector<Phase> phases_;
    std::vector<Task> tasks_;  // of each phase
    PhaseLoop loop_;
};

}  // namespace carom::dynamics
