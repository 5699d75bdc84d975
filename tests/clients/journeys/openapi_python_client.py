"""A journey with the package `hpn_client` that openapi-python-client makes: python openapi_python_client.py ADDRESS."""

import importlib
import json
import sys
from typing import Any


def journey(address: str, cycle: dict[str, Any], motion: dict[str, Any]) -> dict[str, Any]:
    """Answers that its user sees."""
    package: Any = importlib.import_module("hpn_client")
    models: Any = importlib.import_module("hpn_client.models")
    with package.Client(base_url=address, raise_on_unexpected_status=True) as client:

        def call(operation: str, *path: str, **arguments: Any) -> Any:
            module: Any = importlib.import_module(f"hpn_client.api.{operation}")
            answer = module.sync_detailed(*path, client=client, **arguments)
            return int(answer.status_code) if answer.parsed is None else answer.parsed

        application = models.Application(duty_cycle=models.DutyCycle.from_dict(cycle))
        moved = models.Application(duty_cycle=models.DutyCycle(motion=models.RotaryMotion.from_dict(motion)))
        request = models.SaveRequest(application=application, title="Axis 7", reference="python client")
        saved, again = (
            call("saved_selections.save_selection", body=request, idempotency_key="python-client") for _ in range(2)
        )
        selected = call("selection.select", body=application)
        read = call("saved_selections.get_selection", saved.id)
        listed = call("saved_selections.list_selections", reference="python client")
        lives = [one.candidates[0].life_l10_h for one in (selected, read.result)]
        return {
            "selected": selected.selected,
            "figures": [*lives, selected.duty.average_torque_nm],
            "phases": len(call("selection.select", body=moved).duty.phases),
            "saved once": saved.id == again.id,
            "listed": [line.title for line in listed.selections],
            "renamed": call("saved_selections.rename_selection", saved.id, body=models.Names(title="Axis 8")).title,
            "read": read.result.selected,
            "deleted": call("saved_selections.delete_selection", saved.id),
            "missing": call("saved_selections.get_selection", saved.id).status,
            "refused": call("saved_selections.list_selections", cursor="x").errors[0].pointer,
        }


print(json.dumps(journey(sys.argv[1], *map(json.loads, sys.argv[2:4]))))
