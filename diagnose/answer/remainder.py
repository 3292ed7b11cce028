"""What is left beside what was confirmed: noise, scatter of visits, small causes, or what nothing explains."""

from __future__ import annotations

import numpy as np
from scipy.special import chdtri

from linkwright.core.diagnose.fitting.fit import fit, remaining
from linkwright.core.diagnose.fitting.held_out import hardest, splits
from linkwright.core.diagnose.fitting.room.small_causes import SmallCauses, small_causes
from linkwright.core.diagnose.residual.observed import rms_length
from linkwright.core.diagnose.residual.visits import looks_quieter
from linkwright.core.diagnose.result import LackOfFit, Left, SmallBeside

from .confirmation import Confirmed
from .guard.balance import balance_each_other
from .guard.lack_of_fit import refuted_by, refutes
from .guard.scatter import follows
from .unknown import predictable


class Remainder:
    """What is left beside confirmed `names`: `lack_of_fit` is what readings of one pose say of the fit, `small` the
    causes too small to be named that it comes from (None: none), `left_over` whether something is left that nothing
    explains, `may_scatter` whether that may also be an arm that returns badly, as no pose was come back to."""

    def __init__(self, names: Confirmed) -> None:
        self.names, self.observed, self.noise, self.rules = names, names.observed, names.noise, names.rules
        self.scattered = False
        self._predicted: float | None = None
        self.lack_of_fit = self._lack_of_fit()
        self.small = self._small_causes()
        self.left_over = (
            self.small is None
            and not self.what_remains().is_noise
            and (
                self.names.describes_nothing
                or self._left_over()
                or self._refuted_as_whole()
                or self._balance_each_other()
            )
        )
        self.may_scatter = self.left_over and self._like_scatter()

    @property
    def unexplained(self) -> bool:
        """Whether a form, or something that no form fits, is there beside what was named."""
        return bool(self.names.outside or self.left_over)

    def _refuted_as_whole(self) -> bool:
        """Whether what was found is not the whole answer, and no form stands beside it that is the rest."""
        return bool(self.names.members) and not self.names.outside and self.does_not_fit()

    def _balance_each_other(self) -> bool:
        parts = [(self.names.place(place)[1], self.names.moved([place])) for place in range(len(self.names.members))]
        return balance_each_other(parts, self.names.left(()), rules=self.rules.answer)

    def what_remains(self) -> Left:
        """What is left beside the noise floor, of readings fitted and of those held out."""
        floor = None if self.noise.rms_m is None else float(np.hypot(self.noise.rms_m, self.names.wandered()))
        return Left(rms_length(self.names.after()), hardest(self.names.held_out).rms(), floor, self.rules.fitting)

    def _left_over(self) -> bool:
        """Whether far more is left beside the findings than repeats of a pose differ by, though no form fits it, and
        it is there again when a pose is visited again or predicts itself elsewhere."""
        if self.names.named is None or self.names.outside or self.noise.source != "repeats" or self.noise.rms_m is None:
            return False
        rules = self.rules.answer
        width = self.observed.components
        remainder = self.observed.still(self.names.after())
        left = rms_length(remainder)
        floor = self.noise.rms_m * looks_quieter(self.observed)
        limit = (self.rules.fitting.far_above if self.names.members else rules.farther) * floor
        if self.noise.degrees_of_freedom < self.rules.fitting.enough or left <= limit:
            return False
        if self._come_back_to():
            assert self.noise.drift_m is not None
            # As large as scatter may be that came out so small by chance.
            freedom = width * self.noise.drift_degrees_of_freedom
            scatter = self.noise.drift_m**2 * freedom / float(chdtri(freedom, 1.0 - self.rules.residual.level))
            lasting = scatter < (1.0 - rules.lasting) * (left**2 - floor**2)
        else:
            # What was named and leaves most of the mismatch does not explain it, nor is the rest scatter for that.
            unexplained = bool(self.names.members) and self._leaves_most(left)
            lasting = unexplained or self._local_or_predicted()
            # Of a small remainder forms that are picked by what they predict tell more than that by chance.
            lasting = lasting and not (self.names.members and self._only_scatter())
            if not (lasting or self.names.members) and left > rules.too_far_to_scatter * floor:
                # So much is no scatter unless it is seen to scatter, and no pose was come back to.
                lasting = True
        self.scattered = not lasting
        return lasting

    def _lack_of_fit(self, small: SmallCauses | None = None) -> LackOfFit | None:
        """What readings of one pose say of the fit, perhaps with room for small causes; None where nothing was searched
        or too few were repeated."""
        if self.names.named is None:
            return None
        folds = hardest(self.names.folds)
        held_out = hardest(self.names.held_out) if small is None else self.names.held_out_of(folds, small.columns)
        shapes = sum(len(term.candidate.free_shapes) for term in self.names.refit.terms)
        sizes = sum(term.columns.shape[2] for term in self.names.refit.terms)
        forms = sum(self.names.prepared.columns[m].shape[2] for m in self.names.outside)
        return refuted_by(
            self.observed,
            self.observed.still(self.names.after()),
            held_out,
            self.names.prepared.pool.nuisance.shape[1] + shapes + sizes + forms,
            seed=self.names.options.seed,
            rules=self.rules,
            small=small,
        )

    def _small_causes(self) -> SmallBeside | None:
        """The causes too small to be named that what is left beside the findings comes from, where readings of one pose
        refute these as the whole answer and do not with room for those; None where it is no more than noise, or more
        than such causes make."""
        result, observed, rules = self.lack_of_fit, self.observed, self.rules
        alone = not self.names.members or self.names.outside or len(self.names.searched()) < observed.rows
        if result is None or alone or not refutes(result, rules) or self._leaves_most(rms_length(self.names.after())):
            return None
        # What small causes leave is as large where it was not fitted; names that make far more of it do not carry over.
        if result.held_out_times > rules.answer.held_out_beyond * result.times:
            return None
        prepared = self.names.with_what_is_left()
        fitted = fit(prepared, self.names.named_members)
        rivals = [rival.member for others in self.names.alike for rival in others]
        noise = fitted.rss / len(prepared.vector) / result.times**2
        causes = small_causes(prepared, self.names.named_members, rivals, noise)
        if causes is None:
            return None
        again = self._lack_of_fit(causes)
        if again is None or refutes(again, rules):
            return None
        moved = rms_length(causes.likeliest[:, : observed.components])
        return SmallBeside(moved, again)

    def _leaves_most(self, left: float) -> bool:
        """Whether findings that leave an RMS of `left` (m) leave most of the mismatch that is more than noise."""
        if self.noise.rms_m is None:
            return False
        floor = self.noise.rms_m * looks_quieter(self.observed)
        nothing = remaining(self.names.prepared, fit(self.names.prepared, ()))[:, : self.observed.components]
        whole = rms_length(self.observed.still(nothing))
        return left**2 - floor**2 > 0.5 * (whole**2 - floor**2)

    def does_not_fit(self) -> bool:
        """Whether readings of one pose refute what was found, or readings held out do; where there are no repeats,
        whether far more is left than the declared noise, and not by chance."""
        rules, result = self.rules.answer, self.lack_of_fit
        if result is not None:
            misfit = refutes(result, self.rules)
            carries = result.held_out_times <= rules.held_out_beyond * result.times
            if misfit and carries and self.names.members and result.against == "repeats" and self._only_scatter():
                self.scattered = True
                return False
            return misfit
        if self.names.named is None or self.names.named.left is None or self.noise.rms_m is None:
            return False
        by_chance = min(test.p_value for test in self.names.named.left) > self.rules.search.false_alarm
        left = rms_length(self.observed.still(self.names.after()))
        return not by_chance and left > rules.farther * self.noise.rms_m

    def _only_scatter(self) -> bool:
        """Whether what is left beside the findings, more than readings of a visit differ by, is what visits differ by:
        it is everywhere, far less than what was explained, and nothing recorded predicts it from pose to pose."""
        rules, floor = self.rules.answer, self.noise.rms_m
        if floor is None:
            return False
        remainder = self.names.after()
        left, quiet = rms_length(remainder), floor * looks_quieter(self.observed)
        nothing = remaining(self.names.prepared, fit(self.names.prepared, ()))[:, : self.observed.components]
        beyond, whole = left**2 - quiet**2, rms_length(nothing) ** 2 - quiet**2
        local = float(np.median(np.linalg.norm(remainder, axis=1))) < rules.local * left
        if local or beyond > rules.scatter_beside * whole or self._visits_follow() < rules.scatter_follows:
            return False
        # Forms picked by what they predict reach a third of so little by chance.
        if self._predictable() * left**2 > 0.5 * beyond:
            return False
        # So much is not believed unseen, with names as without.
        return left <= rules.too_far_to_scatter * quiet

    def _come_back_to(self) -> bool:
        """Whether poses enough were come back to for how exactly the arm returns."""
        back = self.noise.drift_degrees_of_freedom >= self.rules.fitting.least_parts
        return self.noise.drift_m is not None and back

    def _like_scatter(self) -> bool:
        """Whether what is left of an arm that came back to no pose is what it would leave that returns badly: neither
        library nor forms explain more of it than of visits with random signs, nor are visits like those before."""
        named, rules = self.names.named, self.rules
        if named is None or self.names.outside or self.noise.source != "repeats" or self._come_back_to():
            return False
        by_chance = min(test.p_value for test in named.left or named.gate) > rules.search.false_alarm
        scattered = by_chance and not self._local_or_predicted()
        return scattered and self._visits_follow() >= rules.answer.scatter_follows

    def _local_or_predicted(self) -> bool:
        """Whether what is left sits at a few visits alone, where something happened, or predicts itself elsewhere:
        scatter is everywhere, and does not."""
        rules, remainder = self.rules.answer, self.observed.still(self.names.after())
        local = float(np.median(np.linalg.norm(remainder, axis=1))) < rules.local * rms_length(remainder)
        return local or self._predictable() > rules.lasting

    def _predictable(self) -> float:
        """The share of what is left beside the findings that is predicted where it was not seen; worked out once."""
        if self._predicted is None:
            folds = hardest(splits(self.names.search.observed, self.names.options.seed))
            self._predicted = predictable(self.names.namer, self.names.named_members, folds)
        return self._predicted

    def _visits_follow(self) -> float:
        """The p-value that what is left beside the findings is by chance as much like the visits before."""
        forms = [self.names.prepared.columns[m] for m in self.names.outside]
        columns = [self.names.prepared.beside, *(term.columns for term in self.names.refit.terms), *forms]
        left, fitted = self.observed.still(self.names.after()), np.concatenate(columns, axis=2)
        return follows(self.observed, left, fitted, seed=self.names.options.seed, rules=self.rules)

    def scatter(self) -> float | None:
        """How many times the noise floor what is left scatters by, where that is more than noise and no fault of the
        model that could be found; else None."""
        if self.names.named is None or self.noise.rms_m is None or self.names.outside or self.left_over:
            return None
        times = rms_length(self.observed.still(self.names.after())) / (self.noise.rms_m * looks_quieter(self.observed))
        return times if self.scattered or (not self.names.members and self.does_not_fit()) else None
