import com.fasterxml.jackson.databind.ObjectMapper;
import java.util.LinkedHashMap;
import java.util.List;
import java.util.Map;
import org.openapitools.client.ApiClient;
import org.openapitools.client.ApiException;
import org.openapitools.client.JSON;
import org.openapitools.client.api.SavedSelectionsApi;
import org.openapitools.client.api.SelectionApi;
import org.openapitools.client.model.Application;
import org.openapitools.client.model.DutyCycle;
import org.openapitools.client.model.Motion;
import org.openapitools.client.model.Names;
import org.openapitools.client.model.ProblemReply;
import org.openapitools.client.model.RotaryMotion;
import org.openapitools.client.model.SaveRequest;

/** A journey with the client that openapi-generator makes on Java's own HTTP client: java Journey ADDRESS CYCLE MOTION. */
public class Journey {
    private static final ObjectMapper MAPPER = JSON.getDefault().getMapper();

    private interface Call {
        Object of() throws ApiException;
    }

    private static ProblemReply refusal(Call call) throws Exception {
        try {
            throw new AssertionError(call.of());
        } catch (ApiException refused) {
            return MAPPER.readValue(refused.getResponseBody(), ProblemReply.class);
        }
    }

    public static void main(String[] arguments) throws Exception {
        var client = new ApiClient();
        client.updateBaseUri(arguments[0]);
        var selection = new SelectionApi(client);
        var kept = new SavedSelectionsApi(client);
        var application = new Application().dutyCycle(MAPPER.readValue(arguments[1], DutyCycle.class));
        var motion = new Motion(MAPPER.readValue(arguments[2], RotaryMotion.class));
        var moved = new Application().dutyCycle(new DutyCycle().motion(motion));
        var request = new SaveRequest().application(application).title("Axis 7").reference("java");

        var selected = selection.select(application);
        String id = kept.saveSelection(request, "java", null).getId();
        String again = kept.saveSelection(request, "java", null).getId();
        var read = kept.getSelection(id, null);
        Map<String, Object> found = new LinkedHashMap<>();
        found.put("selected", selected.getSelected());
        found.put("figures", List.of(
            selected.getCandidates().get(0).getLifeL10H(),
            read.getResult().getCandidates().get(0).getLifeL10H(),
            selected.getDuty().getAverageTorqueNm()));
        found.put("phases", selection.select(moved).getDuty().getPhases().size());
        found.put("saved once", id.equals(again));
        found.put("listed", kept.listSelections("java", null, null, null, null).getSelections().stream()
            .map(line -> line.getTitle()).toList());
        found.put("renamed", kept.renameSelection(id, new Names().title("Axis 8"), null).getTitle());
        found.put("read", read.getResult().getSelected());
        found.put("deleted", kept.deleteSelectionWithHttpInfo(id, null).getStatusCode());
        found.put("missing", refusal(() -> kept.getSelection(id, null)).getStatus());
        found.put("refused", refusal(() -> kept.listSelections(null, null, "x", null, null)).getErrors().get(0).getPointer());
        System.out.println(MAPPER.writeValueAsString(found));
    }
}
