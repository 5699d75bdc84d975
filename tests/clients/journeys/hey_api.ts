/** A journey with the client that @hey-api/openapi-ts makes: node hey_api.js ADDRESS CYCLE MOTION. */
import {
    type Application,
    type DutyCycle,
    type RotaryMotion,
    type SaveRequest,
    deleteSelection,
    getSelection,
    listSelections,
    renameSelection,
    saveSelection,
    select,
} from "./hpn_client/index.js";
import { client } from "./hpn_client/client.gen.js";

declare const process: { argv: string[] };

const [address, cycle, motion] = process.argv.slice(2) as [string, string, string];
client.setConfig({ baseUrl: address });

const application: Application = { duty_cycle: JSON.parse(cycle) as DutyCycle };
const moved: Application = { duty_cycle: { motion: JSON.parse(motion) as RotaryMotion } };
const body: SaveRequest = { application, title: "Axis 7", reference: "hey-api" };
const once = { body, headers: { "Idempotency-Key": "hey-api" } };

const selected = await select({ body: application });
const phases = await select({ body: moved });
const saved = await saveSelection(once);
const again = await saveSelection(once);
const path = { id: saved.data!.id };
const listed = await listSelections({ query: { reference: "hey-api" } });
const renamed = await renameSelection({ path, body: { title: "Axis 8" } });
const read = await getSelection({ path });
const deleted = await deleteSelection({ path });
const missing = await getSelection({ path });
const refused = await listSelections({ query: { cursor: "x" } });
console.log(
    JSON.stringify({
        selected: selected.data?.selected,
        figures: [
            ...[selected.data, read.data?.result].map((one) => one?.candidates[0]?.life_L10_h),
            selected.data?.duty.average_torque_Nm,
        ],
        phases: phases.data?.duty.phases?.length,
        "saved once": saved.data?.id === again.data?.id,
        listed: listed.data?.selections.map((line) => line.title),
        renamed: renamed.data?.title,
        read: read.data?.result.selected,
        deleted: deleted.response?.status,
        missing: missing.error?.status,
        refused: refused.error?.errors?.[0]?.pointer,
    }),
);
