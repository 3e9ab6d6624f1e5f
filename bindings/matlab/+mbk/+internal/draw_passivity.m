function handles = draw_passivity(document)
% Plots the absorbed energy if the document contains it, and the passivity index of each model with its band.
  if isstruct(document) && isfield(document, 'results')
    several = mbk.internal.items(document.results);
    document = several{1};
  end
  if ~isstruct(document) || ~isfield(document, 'passivity')
    error('mbk:usage', 'this result has no passivity; give a result of mbk.measure or mbk.passivity for one recording');
  end
  recordings = {};
  if isfield(document, 'recordings')
    recordings = mbk.internal.items(document.recordings);
  end
  models = {};
  if isfield(document.passivity, 'models')
    models = mbk.internal.items(document.passivity.models);
  end
  panels = 1 + ~isempty(recordings);
  colours = {'first', 'second', 'damping', 'inertia'};
  handles = zeros(1, 0);
  if ~isempty(recordings)
    handles(end + 1) = subplot(panels, 1, 1);
    for k = 1:numel(recordings)
      plot(recordings{k}.time_s, recordings{k}.absorbed_J, ...
           'Color', mbk.internal.style(colours{mod(k - 1, 4) + 1}), 'LineWidth', 1.2);
      hold on
    end
    hold off
    grid on
    mbk.internal.label('time (s)', 'absorbed energy (J)');
  end
  handles(end + 1) = subplot(panels, 1, panels);
  lines = zeros(1, 0);
  names = {};
  for k = 1:numel(models)
    if ~isfield(models{k}, 'index')
      continue
    end
    index = models{k}.index;
    [colour, light] = mbk.internal.style(colours{mod(k - 1, 4) + 1});
    mbk.internal.band(index.frequency_hz, index.lower95, index.upper95, light);
    lines(end + 1) = semilogx(index.frequency_hz, index.value, 'Color', colour, 'LineWidth', 1.2);
    hold on
    names{end + 1} = method(models{k}.method);
  end
  limits = xlim();
  plot(limits, [0 0], 'Color', mbk.internal.style('other'));
  hold off
  set(gca, 'XScale', 'log');
  if ~isempty(lines)
    legend(lines, names, 'Location', 'northeast');
  end
  grid on
  mbk.internal.label('frequency (Hz); below zero the model can generate energy, bands are 95 % intervals', ...
                     mbk.internal.with_unit('passivity index', mbk.internal.unit_of(document, 'B')));
end

function name = method(word)
% Full name of a method.
  words = {'ls', 'iv'};
  names = {'least squares', 'instrumental variables'};
  name = [names{strcmp(word, words)}];
  if isempty(name)
    name = strrep(word, '_', ' ');
  end
end
