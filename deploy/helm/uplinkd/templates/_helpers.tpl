{{- define "uplinkd.fullname" -}}
{{- if .Values.fullnameOverride -}}
{{- .Values.fullnameOverride | trunc 52 | trimSuffix "-" -}}
{{- else if contains .Chart.Name .Release.Name -}}
{{- .Release.Name | trunc 52 | trimSuffix "-" -}}
{{- else -}}
{{- printf "%s-%s" .Release.Name .Chart.Name | trunc 52 | trimSuffix "-" -}}
{{- end -}}
{{- end -}}

{{- define "uplinkd.selector" -}}
app.kubernetes.io/name: {{ .Chart.Name }}
app.kubernetes.io/instance: {{ .Release.Name }}
app.kubernetes.io/component: server
{{- end -}}

{{- /* Of what is no server, so that no selector of servers finds it. */ -}}
{{- define "uplinkd.commonLabels" -}}
helm.sh/chart: {{ printf "%s-%s" .Chart.Name .Chart.Version | replace "+" "_" }}
app.kubernetes.io/name: {{ .Chart.Name }}
app.kubernetes.io/instance: {{ .Release.Name }}
app.kubernetes.io/version: {{ .Chart.AppVersion | quote }}
app.kubernetes.io/managed-by: {{ .Release.Service }}
{{- end -}}

{{- define "uplinkd.labels" -}}
{{ include "uplinkd.commonLabels" . }}
app.kubernetes.io/component: server
{{- end -}}

{{- define "uplinkd.image" -}}
{{- with .Values.image -}}
{{- if .digest -}}
{{ .repository }}@{{ .digest }}
{{- else -}}
{{ .repository }}:{{ .tag | default $.Chart.AppVersion }}
{{- end -}}
{{- end -}}
{{- end -}}

{{- define "uplinkd.serviceAccount" -}}
{{- if .Values.serviceAccount.create -}}
{{ .Values.serviceAccount.name | default (include "uplinkd.fullname" .) }}
{{- else -}}
{{ .Values.serviceAccount.name | default "default" }}
{{- end -}}
{{- end -}}

{{- define "uplinkd.tlsSecret" -}}
{{ .Values.tls.secret | default (printf "%s-tls" (include "uplinkd.fullname" .)) }}
{{- end -}}

{{- /* Whether others than the robots may ask. */ -}}
{{- define "uplinkd.asked" -}}
{{- if or .Values.http.enabled .Values.fleet.enabled -}}yes{{- end -}}
{{- end -}}

{{- define "uplinkd.podSecurity" -}}
runAsNonRoot: true
runAsUser: 10001
runAsGroup: 10001
fsGroup: 10001
fsGroupChangePolicy: OnRootMismatch
seccompProfile:
  type: RuntimeDefault
{{- end -}}

{{- define "uplinkd.containerSecurity" -}}
allowPrivilegeEscalation: false
readOnlyRootFilesystem: true
capabilities:
  drop: [ALL]
{{- end -}}

{{- /* One value of uplinkd.toml. A number of a values file is a float here, a text stays one. */ -}}
{{- define "uplinkd.tomlValue" -}}
{{- if kindIs "slice" . -}}
[{{ range $at, $each := . }}{{ if $at }}, {{ end }}{{ include "uplinkd.tomlValue" $each }}{{ end }}]
{{- else if kindIs "string" . -}}
{{ toJson . }}
{{- else if kindIs "bool" . -}}
{{ . }}
{{- else -}}
{{ int64 . }}
{{- end -}}
{{- end -}}

{{- define "uplinkd.toml" -}}
{{- $own := dict
  "listen" (dict "metrics" "[::]:7481" "proxy_protocol_from" .Values.service.proxyProtocolFrom)
  "tls" (dict "certificate_file" "/etc/uplinkd/tls/tls.crt" "key_file" "/etc/uplinkd/tls/tls.key"
              "client_ca_file" (printf "/etc/uplinkd/robots/%s" .Values.tls.robotsKey))
  "drain" (dict "timeout" (printf "%ds" (int64 .Values.drain.timeoutSeconds)))
  "store" (dict "url" "sqlite:///var/lib/uplinkd/uplinkd.db")
-}}
{{- if eq .Values.store.type "postgres" -}}
{{- $_ := set $own.store "url" .Values.store.postgres.url -}}
{{- $_ := set $own.store "password_file" (printf "/etc/uplinkd/store/%s" .Values.store.postgres.passwordKey) -}}
{{- end -}}
{{- if .Values.tls.robotsCrlKey -}}
{{- $_ := set $own.tls "client_crl_file" (printf "/etc/uplinkd/robots/%s" .Values.tls.robotsCrlKey) -}}
{{- end -}}
{{- if .Values.tls.operatorsSecret -}}
{{- $_ := set $own.tls "operator_ca_file" (printf "/etc/uplinkd/operators/%s" .Values.tls.operatorsKey) -}}
{{- if .Values.tls.operatorsCrlKey -}}
{{- $_ := set $own.tls "operator_crl_file" (printf "/etc/uplinkd/operators/%s" .Values.tls.operatorsCrlKey) -}}
{{- end -}}
{{- end -}}
{{- if .Values.tls.authoritiesConfigMap -}}
{{- $_ := set $own "identity" (dict "authorities" "/etc/uplinkd/authorities") -}}
{{- end -}}
{{- if .Values.fleet.enabled -}}
{{- $_ := set $own.listen "fleet" "[::]:7444" -}}
{{- end -}}
{{- $http := dict -}}
{{- if and (include "uplinkd.asked" .) .Values.http.tokensSecret -}}
{{- $_ := set $http "tokens_file" (printf "/etc/uplinkd/access/%s" .Values.http.tokensKey) -}}
{{- end -}}
{{- if .Values.http.enabled -}}
{{- $service := printf "%s-http" (include "uplinkd.fullname" .) -}}
{{- $names := list $service (printf "%s.%s" $service .Release.Namespace) (printf "%s.%s.svc" $service .Release.Namespace) -}}
{{- $_ := set $own.listen "http" "[::]:7480" -}}
{{- $_ := set $http "hosts" (concat $names .Values.http.hosts (dig "http" "hosts" (list) .Values.config)) -}}
{{- $_ := set $http "tls.certificate_file" "/etc/uplinkd/http/tls.crt" -}}
{{- $_ := set $http "tls.key_file" "/etc/uplinkd/http/tls.key" -}}
{{- /* The probes ask over loopback. */ -}}
{{- $_ := set $http "plain_from" (concat (list "127.0.0.0/8" "::1") .Values.http.plainFrom) -}}
{{- end -}}
{{- if .Values.metrics.tokenSecret -}}
{{- $_ := set $http "metrics_token_file" (printf "/etc/uplinkd/metrics/%s" .Values.metrics.tokenKey) -}}
{{- end -}}
{{- if $http -}}
{{- $_ := set $own "http" $http -}}
{{- end -}}
{{- $all := mergeOverwrite (deepCopy .Values.config) $own -}}
{{- range $section := keys $all | sortAlpha }}
[{{ $section }}]
{{- range $key := keys (get $all $section) | sortAlpha }}
{{ $key }} = {{ include "uplinkd.tomlValue" (get (get $all $section) $key) }}
{{- end }}
{{ end }}
{{- end -}}
