"""Many applications at once: the batch behind a PLM system's ten thousand axes."""

from collections import defaultdict
from collections.abc import Sequence

from hpn.application import Application, InputError
from hpn.catalogue import Catalogue, GearList
from hpn.engine.allowed import gears_for, with_listed_motor
from hpn.engine.chunks import chunks_of
from hpn.engine.duty import Duty
from hpn.engine.evaluation import evaluate
from hpn.engine.selection import Judged


def judge_batch(applications: Sequence[Application], catalogue: Catalogue) -> list[Judged | InputError]:
    """Each application on its gears, or the reason why it has none, in their order.

    Applications with the same candidates are evaluated together, in chunks that stay inside the processor's cache.
    """
    results: list[Judged | InputError | None] = [None] * len(applications)
    equipped = list(applications)
    groups: dict[GearList, list[int]] = defaultdict(list)
    for index, application in enumerate(applications):
        try:
            equipped[index] = with_listed_motor(application, catalogue)
            groups[gears_for(application, catalogue)].append(index)
        except InputError as error:
            results[index] = error
    for gears, indices in groups.items():
        for chunk in chunks_of([len(applications[index].duty_cycle.load_phases) for index in indices]):
            members = [indices[place] for place in chunk.tolist()]
            evaluation = evaluate(Duty.of([equipped[index] for index in members]), gears, catalogue)
            for place, index in enumerate(members):
                results[index] = Judged(applications[index], evaluation, place)
    return [result for result in results if result is not None]
