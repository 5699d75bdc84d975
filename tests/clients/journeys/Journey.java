import com.google.gson.Gson;
import java.util.Arrays;
import java.util.LinkedHashMap;
import java.util.Map;
import java.util.stream.Collectors;
import org.openapitools.client.ApiClient;
import org.openapitools.client.ApiException;
import org.openapitools.client.api.SavedSelectionsApi;
import org.openapitools.client.api.SelectionApi;
import org.openapitools.client.model.Application;
import org.openapitools.client.model.DutyCycle;
import org.openapitools.client.model.Motion;
import org.openapitools.client.model.Names;
import org.openapitools.client.model.ProblemReply;
import org.openapitools.client.model.RotaryMotion;
import org.openapitools.client.model.SaveRequest;
import org.openapitools.client.model.SavedSelectionReply;
import org.openapitools.client.model.Selection;
import org.openapitools.client.model.SelectionListReply;

/** A journey with the client that openapi-generator makes without any option: java Journey ADDRESS CYCLE MOTION. */
public class Journey {
    private interface Call {
        Object of() throws ApiException;
    }

    private static ProblemReply refusal(Call call) throws Exception {
        try {
            throw new AssertionError(call.of());
        } catch (ApiException refused) {
            return ProblemReply.fromJson(refused.getResponseBody());
        }
    }

    private static SelectionListReply list(SavedSelectionsApi kept, String reference, String cursor) throws ApiException {
        return kept.listSelections(null, reference, null, null, null, null, null, null, null, cursor, null, null);
    }

    public static void main(String[] arguments) throws Exception {
        ApiClient client = new ApiClient();
        client.setBasePath(arguments[0]);
        SelectionApi selection = new SelectionApi(client);
        SavedSelectionsApi kept = new SavedSelectionsApi(client);
        Application application = new Application().dutyCycle(DutyCycle.fromJson(arguments[1]));
        Motion motion = new Motion(RotaryMotion.fromJson(arguments[2]));
        Application moved = new Application().dutyCycle(new DutyCycle().motion(motion));
        SaveRequest request = new SaveRequest().application(application).title("Axis 7").reference("java");

        Selection selected = selection.select(application, null, null, null);
        String id = kept.saveSelection(request, "java", null).getId();
        String again = kept.saveSelection(request, "java", null).getId();
        SavedSelectionReply read = kept.getSelection(id, null, null);
        Map<String, Object> found = new LinkedHashMap<>();
        found.put("selected", selected.getSelected());
        found.put("figures", Arrays.asList(
            selected.getCandidates().get(0).getLifeL10H(),
            read.getResult().getCandidates().get(0).getLifeL10H(),
            selected.getDuty().getAverageTorqueNm()));
        found.put("phases", selection.select(moved, null, null, null).getDuty().getPhases().size());
        found.put("saved once", id.equals(again));
        found.put("listed", list(kept, "java", null).getSelections().stream().map(line -> line.getTitle())
            .collect(Collectors.toList()));
        found.put("renamed", kept.renameSelection(id, new Names().title("Axis 8"), null).getTitle());
        found.put("read", read.getResult().getSelected());
        found.put("deleted", kept.deleteSelectionWithHttpInfo(id, null).getStatusCode());
        found.put("missing", refusal(() -> kept.getSelection(id, null, null)).getStatus());
        found.put("refused", refusal(() -> list(kept, null, "x")).getErrors().get(0).getPointer());
        System.out.println(new Gson().toJson(found));
        client.getHttpClient().dispatcher().executorService().shutdown();
        client.getHttpClient().connectionPool().evictAll();
    }
}
