function [result, info] = study(what, varargin)
% mbk.study  Subcommands of 'mbk study': init, defaults, add, import, list, show, measure, status, exclude, summary,
%   plan, report, export, forget, check, log, backup.
%
%   [RESULT, INFO] = mbk.study('init', ..., NAME, VALUE, ...) runs 'mbk study init'. After the name of the
%   subcommand come data (see 'help mbk.measure'), file names or other words, as a text or a cell array of several,
%   then options with their values. RESULT is the document of --json as a struct, or the text that the command prints.
%
%   Error identifiers: mbk:usage, mbk:data, mbk:not_usable. Warning identifiers: mbk:CODE, with _ for -.
  [result, info] = mbk.internal.run(['study ' char(what)], varargin);
end
