FROM {base}
RUN groupadd --system --gid 999 postgres && useradd --system --uid 999 --gid postgres --home-dir /var/lib/postgresql postgres \
    && apt-get update -q && mkdir -p /etc/postgresql-common && echo "create_main_cluster = false" > /etc/postgresql-common/createcluster.conf \
    && apt-get install -q -y --no-install-recommends postgresql-{major} \
    && install --directory --mode=1777 --owner=postgres --group=postgres /var/lib/postgresql/data /var/run/postgresql \
    && rm -rf /var/lib/apt/lists/* && echo "$(. /etc/os-release; echo $PRETTY_NAME), $(/usr/lib/postgresql/{major}/bin/postgres --version)" > /stand-in
COPY postgres-entrypoint.sh /usr/local/bin/docker-entrypoint.sh
ENV PATH=/usr/lib/postgresql/{major}/bin:/usr/local/bin:/usr/bin:/bin LANG=C.UTF-8 PGDATA=/var/lib/postgresql/data
VOLUME /var/lib/postgresql/data
STOPSIGNAL SIGINT
EXPOSE 5432
ENTRYPOINT ["sh", "/usr/local/bin/docker-entrypoint.sh"]
CMD ["postgres"]
