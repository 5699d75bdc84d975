"""A journey with the package `hpn_client` that openapi-generator makes: python openapi_generator.py ADDRESS."""

import importlib
import json
import sys
from typing import Any


def journey(address: str, cycle: dict[str, Any], motion: dict[str, Any]) -> dict[str, Any]:
    """Answers that its user sees."""
    package: Any = importlib.import_module("hpn_client")
    with package.ApiClient(package.Configuration(host=address)) as client:
        selection, record = package.SelectionApi(client), package.SavedSelectionsApi(client)

        def refusal(call: Any, **arguments: Any) -> Any:
            try:
                call(**arguments)
            except package.ApiException as error:
                return error.data

        application = package.Application(duty_cycle=package.DutyCycle.from_dict(cycle))
        turning = package.Motion(package.RotaryMotion.from_dict(motion))
        moved = package.Application(duty_cycle=package.DutyCycle(motion=turning))
        request = package.SaveRequest(application=application, title="Axis 7", reference="python generator")
        saved, again = (
            record.save_selection(save_request=request, idempotency_key="python-generator") for _ in range(2)
        )
        selected, read = selection.select(application), record.get_selection(saved.id)
        listed = record.list_selections(reference="python generator")
        lives = [one.candidates[0].life_l10_h for one in (selected, read.result)]
        return {
            "selected": selected.selected,
            "figures": [*lives, selected.duty.average_torque_nm],
            "phases": len(selection.select(moved).duty.phases),
            "saved once": saved.id == again.id,
            "listed": [line.title for line in listed.selections],
            "renamed": record.rename_selection(saved.id, package.Names(title="Axis 8")).title,
            "read": read.result.selected,
            "deleted": record.delete_selection_with_http_info(saved.id).status_code,
            "missing": refusal(record.get_selection, id=saved.id).status,
            "refused": refusal(record.list_selections, cursor="x").errors[0].pointer,
        }


print(json.dumps(journey(sys.argv[1], *map(json.loads, sys.argv[2:4]))))
