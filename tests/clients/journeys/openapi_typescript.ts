/** A journey with the types that openapi-typescript makes, by openapi-fetch: node openapi_typescript.js ADDRESS CYCLE MOTION. */
import createClient from "openapi-fetch";
import type { components, paths } from "./schema.js";

declare const process: { argv: string[] };

type Schemas = components["schemas"];

const [address, cycle, motion] = process.argv.slice(2) as [string, string, string];
const client = createClient<paths>({ baseUrl: address });
const one = "/api/v1/selections/{id}";

const application: Schemas["Application"] = { duty_cycle: JSON.parse(cycle) as Schemas["DutyCycle"] };
const moved: Schemas["Application"] = { duty_cycle: { motion: JSON.parse(motion) as Schemas["RotaryMotion"] } };
const request: Schemas["SaveRequest"] = { application, title: "Axis 7", reference: "typescript types" };
const once = { body: request, params: { header: { "Idempotency-Key": "typescript-types" } } };

const selected = await client.POST("/api/v1/select", { body: application });
const phases = await client.POST("/api/v1/select", { body: moved });
const saved = await client.POST("/api/v1/selections", once);
const again = await client.POST("/api/v1/selections", once);
const params = { path: { id: saved.data!.id } };
const listed = await client.GET("/api/v1/selections", { params: { query: { reference: "typescript types" } } });
const renamed = await client.PATCH(one, { params, body: { title: "Axis 8" } });
const read = await client.GET(one, { params });
const deleted = await client.DELETE(one, { params });
const missing = await client.GET(one, { params });
const refused = await client.GET("/api/v1/selections", { params: { query: { cursor: "x" } } });
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
        deleted: deleted.response.status,
        missing: missing.error?.status,
        refused: refused.error?.errors?.[0]?.pointer,
    }),
);
