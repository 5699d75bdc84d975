FROM {base}
RUN groupadd --system --gid 101 nginx && useradd --system --uid 101 --gid nginx --no-create-home nginx \
    && apt-get update -q && apt-get install -q -y --no-install-recommends nginx gettext-base curl ca-certificates \
    && rm -rf /var/lib/apt/lists/* && echo "$(. /etc/os-release; echo $PRETTY_NAME), $(nginx -v 2>&1)" > /stand-in
STOPSIGNAL SIGQUIT
CMD ["nginx", "-g", "daemon off;"]
