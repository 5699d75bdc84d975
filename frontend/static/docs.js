// The OpenAPI document as a page, by Swagger UI; nothing is asked of another host.
SwaggerUIBundle({ url: "/openapi.json", dom_id: "#docs", deepLinking: true, validatorUrl: null });
