/** A journey with the client `hpn_client` that openapi-generator makes: node openapi_generator.js ADDRESS CYCLE. */
import {
    Configuration,
    DutyCycleFromJSON,
    ResponseError,
    SavedSelectionsApi,
    SelectionApi,
    type Application,
} from "./hpn_client/index.js";

declare const process: { argv: string[] };

const [address, cycle] = process.argv.slice(2) as [string, string];
const configuration = new Configuration({ basePath: address });
const selection = new SelectionApi(configuration);
const kept = new SavedSelectionsApi(configuration);

async function refusal(call: Promise<unknown>): Promise<any> {
    try {
        return await call;
    } catch (error) {
        if (error instanceof ResponseError) return await error.response.json();
        throw error;
    }
}

const application: Application = { dutyCycle: DutyCycleFromJSON(JSON.parse(cycle)) };
const request = {
    saveRequest: { application, title: "Axis 7", reference: "typescript generator" },
    idempotencyKey: "typescript-generator",
};
const selected = await selection.select({ application });
const saved = await kept.saveSelection(request);
const again = await kept.saveSelection(request);
const id = saved.id;
const listed = await kept.listSelections({ reference: "typescript generator" });
const renamed = await kept.renameSelection({ id, names: { title: "Axis 8" } });
const read = await kept.getSelection({ id });
const deleted = await kept.deleteSelectionRaw({ id });
console.log(
    JSON.stringify({
        selected: selected.selected,
        figures: [
            ...[selected, read.result].map((one) => one.candidates[0]?.lifeL10H),
            selected.duty.averageTorqueNm,
        ],
        "saved once": id === again.id,
        listed: listed.selections.map((line) => line.title),
        renamed: renamed.title,
        read: read.result.selected,
        deleted: deleted.raw.status,
        missing: (await refusal(kept.getSelection({ id }))).status,
        refused: (await refusal(kept.listSelections({ cursor: "x" }))).errors[0].pointer,
    }),
);
