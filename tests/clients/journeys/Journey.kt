/** A journey with the client that openapi-generator makes in Kotlin: java JourneyKt ADDRESS CYCLE. */
import org.openapitools.client.apis.SavedSelectionsApi
import org.openapitools.client.apis.SelectionApi
import org.openapitools.client.infrastructure.ClientError
import org.openapitools.client.infrastructure.ClientException
import org.openapitools.client.infrastructure.Serializer
import org.openapitools.client.models.Application
import org.openapitools.client.models.DutyCycle
import org.openapitools.client.models.Names
import org.openapitools.client.models.ProblemReply
import org.openapitools.client.models.SaveRequest

fun refusal(call: () -> Any): ProblemReply =
    try {
        throw AssertionError(call())
    } catch (refused: ClientException) {
        val body = (refused.response as ClientError<*>).body as String
        Serializer.moshi.adapter(ProblemReply::class.java).fromJson(body)!!
    }

fun main(arguments: Array<String>) {
    val (address, cycle) = arguments
    val selection = SelectionApi(address)
    val kept = SavedSelectionsApi(address)
    val application = Application(dutyCycle = Serializer.moshi.adapter(DutyCycle::class.java).fromJson(cycle)!!)
    val request = SaveRequest(application = application, title = "Axis 7", reference = "kotlin")

    val selected = selection.select(application)
    val id = kept.saveSelection(request, "kotlin").id
    val again = kept.saveSelection(request, "kotlin").id
    val read = kept.getSelection(id)
    val lives = listOf(selected, read.result).map { it.candidates[0].lifeL10H }
    val found =
        mapOf(
            "selected" to selected.selected,
            "figures" to lives + selected.duty.averageTorqueNm,
            "saved once" to (id == again),
            "listed" to kept.listSelections(reference = "kotlin").selections.map { it.title },
            "renamed" to kept.renameSelection(id, Names(title = "Axis 8")).title,
            "read" to read.result.selected,
            "deleted" to kept.deleteSelectionWithHttpInfo(id, null).statusCode,
            "missing" to refusal { kept.getSelection(id) }.status,
            "refused" to refusal { kept.listSelections(cursor = "x") }.errors!![0].pointer,
        )
    println(Serializer.moshi.adapter(Any::class.java).toJson(found))
}
